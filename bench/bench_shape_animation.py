"""How many pictures a second of a moving mode shape reach the terminal, at 160 x 45.

`armodal review` runs in a terminal of this program's own, which takes part in synchronised output
(mode 2026), so that every picture that arrives whole is counted. Other work is simulated by
processes that never rest. Target: 15 pictures a second or more.

    python bench/bench_shape_animation.py [--seconds 20] [--busy 0] [--columns 160] [--rows 45]
"""

from __future__ import annotations

import argparse
import fcntl
import json
import os
import pty
import select
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time
from itertools import pairwise
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from bench_run_app import cpu_s
from support.offline_lab import simulate_session

from armodal.protocols.session.hdf5 import write_session

ROOT = Path(__file__).parents[1]
ASKED, ANSWER = b"\x1b[?2026$p", b"\x1b[?2026;2$y"
PICTURE_ENDS = b"\x1b[?2026l"
SETTLE_S = 2.0


class Window:
    """A pseudo-terminal that counts whole pictures."""

    def __init__(self, command: list[str], columns: int, rows: int) -> None:
        self._fd, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        words = {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "TERM": "xterm-256color"}
        self._process = subprocess.Popen(
            command,
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            cwd=ROOT,
            env={**os.environ, **words},
            start_new_session=True,
        )
        os.close(theirs)
        self._tail = b""
        self.n_bytes = 0

    def cpu_s(self) -> float:
        """Return the processor time of the app."""
        return cpu_s(self._process.pid)

    def close(self) -> None:
        """End the app."""
        self._process.kill()
        self._process.wait()
        os.close(self._fd)

    def press(self, keys: bytes) -> None:
        """Press keys."""
        os.write(self._fd, keys)

    def until(self, words: bytes, timeout_s: float) -> None:
        """Read on until the words have come."""
        end_s, seen = time.monotonic() + timeout_s, b""
        while words not in seen:
            if time.monotonic() > end_s:
                raise TimeoutError(f"{words!r} did not come in {timeout_s:g} s: {seen[-2000:]!r}")
            seen += self._read()

    def pictures_s(self, seconds: float) -> list[float]:
        """Return when each picture had arrived whole."""
        end_s, found = time.monotonic() + seconds, []
        while time.monotonic() < end_s:
            before = self._tail
            chunk = self._read()
            whole = (before + chunk).count(PICTURE_ENDS) - before.count(PICTURE_ENDS)
            found += [time.monotonic()] * whole
        return found

    def _read(self) -> bytes:
        if not select.select([self._fd], [], [], 0.5)[0]:
            return b""
        chunk = os.read(self._fd, 65536)
        self.n_bytes += len(chunk)
        if ASKED in self._tail + chunk:
            os.write(self._fd, ANSWER)
        self._tail = (self._tail + chunk)[-len(ASKED) :] if ASKED not in chunk else b""
        return chunk


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--busy", type=int, default=0)
    parser.add_argument("--columns", type=int, default=160)
    parser.add_argument("--rows", type=int, default=45)
    wanted = parser.parse_args()
    busy: list[subprocess.Popen[bytes]] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "s.h5"
        write_session(simulate_session(4, hits_per_point=2), path)
        command = [sys.executable, "-m", "armodal.tui.cli", "review", str(path)]
        window = Window(command, wanted.columns, wanted.rows)
        try:
            window.until(b"modes automatic", 120.0)
            window.press(b"6")
            window.until(b"amplitude", 30.0)
            window.pictures_s(10.0)  # the other postures are fitted meanwhile
            endless = "while True: pass"
            busy += [subprocess.Popen([sys.executable, "-c", endless]) for _ in range(wanted.busy)]
            window.pictures_s(SETTLE_S)
            begun_cpu_s, begun_s = window.cpu_s(), time.monotonic()
            begun_bytes = window.n_bytes
            at_s = window.pictures_s(wanted.seconds)
            passed_s = time.monotonic() - begun_s
            used_s = window.cpu_s() - begun_cpu_s
            n_bytes = window.n_bytes - begun_bytes
        finally:
            for process in busy:
                process.kill()
                process.wait()
            window.close()
    gaps_ms = sorted(1e3 * (b - a) for a, b in pairwise(at_s))
    found = {
        "columns": wanted.columns,
        "rows": wanted.rows,
        "busy_processes": wanted.busy,
        "pictures": len(at_s),
        "pictures_a_second": round(len(at_s) / passed_s, 1),
        "between_pictures_ms_median": round(statistics.median(gaps_ms), 1),
        "between_pictures_ms_p95": round(gaps_ms[int(0.95 * len(gaps_ms))], 1),
        "app_core_share_percent": round(100.0 * used_s / passed_s, 1),
        "app_ms_a_picture": round(1e3 * used_s / len(at_s), 2),
        "bytes_a_picture": n_bytes // len(at_s),
        "load_average": os.getloadavg(),
    }
    print(json.dumps(found, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
