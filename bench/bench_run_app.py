"""A whole session in a real terminal by keys only: 3 postures x 18 points x 3 hits.

Somebody who only does what the screen says presses the keys. Printed are the app's share of a
core, the time from a record in the journal to its verdict on the terminal, how often the live view
was drawn, and what was lost. Targets: below 35 % of a core, every verdict within 150 ms, live views
at 10 Hz, nothing lost.

    python bench/bench_run_app.py [--time-scale 8] [--points 18] [--columns 160] [--rows 45]
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.key_operator import act_until_done
from support.terminal import Terminal, armodal
from terminal_watch import TerminalWatch

from armodal.protocols.plan import PLANS_DIRECTORY
from armodal.protocols.session.journal import load_journal

LEAST_HIT_BYTES = 8_000  # a record with 2048 samples of four channels; marks are far smaller
SAME_RECORD_S = 0.05
LATEST_MS = 150.0
TICKS_HZ = os.sysconf("SC_CLK_TCK")


def plan_of(points: int, folder: Path) -> Path:
    """Write the shipped plan without its validation postures, with the first points only."""
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    head, *postures = text.split("[[postures]]")
    kept = [p for p in postures if "validation = true" not in p]
    names = ", ".join(f'"{i + 1}"' for i in range(points))
    kept = [re.sub(r"points = \[[^\]]*\]", f"points = [{names}]", p) for p in kept]
    path = folder / "bench.toml"
    path.write_text("[[postures]]".join([head, *kept]), encoding="utf-8")
    return path


class JournalWatch(threading.Thread):
    """Note when records reach the journal's file."""

    def __init__(self, journal: Path) -> None:
        super().__init__(daemon=True)
        self._journal = journal
        self.written_s: list[float] = []  # of every hit record, in order

    def run(self) -> None:
        """Look at the file every millisecond."""
        size = 0
        while True:
            time.sleep(0.001)
            now_size = self._journal.stat().st_size if self._journal.exists() else 0
            now_s = time.monotonic()
            # One record may be seen to grow in two steps.
            apart = not self.written_s or now_s - self.written_s[-1] > SAME_RECORD_S
            if now_size - size > LEAST_HIT_BYTES and size and apart:
                self.written_s.append(now_s)
            size = now_size


def cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_HZ


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--time-scale", type=float, default=8.0)
    parser.add_argument("--points", type=int, default=18)
    parser.add_argument("--columns", type=int, default=160)
    parser.add_argument("--rows", type=int, default=45)
    parser.add_argument("--timeout", type=float, default=900.0)
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder_name:
        folder = Path(folder_name)
        journal, fifo = folder / "bench.journal", folder / "screen"
        os.mkfifo(fifo)
        command = armodal("run", str(plan_of(wanted.points, folder)), "--sim")
        command += ["--session", str(journal), "--time-scale", str(wanted.time_scale)]
        watch, told = JournalWatch(journal), TerminalWatch(fifo)
        with Terminal(command, columns=wanted.columns, rows=wanted.rows) as terminal:
            terminal.record_to(fifo)
            watch.start()
            told.start()
            terminal.until("Are these sensors mounted", 120.0)
            pid = terminal.program_pid()
            begun_s, begun_cpu_s = time.monotonic(), cpu_s(pid)
            used: list[float] = [0.0, 0.0]

            def look(screen: str) -> None:
                told.look(screen)
                if "hits left" in screen:
                    used[:] = [time.monotonic() - begun_s, cpu_s(pid) - begun_cpu_s]

            try:
                screen = act_until_done(terminal, wanted.timeout, look)
            except AssertionError:
                screen = terminal.screen()  # not done in time: what there is, is still told
            terminal.keys("q")
            terminal.until("ended", 30.0)
        session = load_journal(journal)
        numbers = [hit.number for hit in session.hits]
        delays_ms = sorted(
            1e3 * (told.shown_s[number] - written_s)
            for number, written_s in zip(numbers, watch.written_s, strict=False)
            if number in told.shown_s
        )
        live_hz = told.live_view_hz()
        lost = re.findall(r"lost: (.*)", screen)
        found = {
            "complete": session.complete,
            "hits": len(numbers),
            "accepted": len(session.accepted()),
            "wall_s": round(used[0], 1),
            "app_core_share_percent": round(100.0 * used[1] / max(used[0], 1e-9), 1),
            "records_seen_written": len(watch.written_s),
            "verdicts_seen": len(delays_ms),
            "verdict_ms_median": round(statistics.median(delays_ms), 1) if delays_ms else None,
            "verdict_ms_p95": round(delays_ms[int(0.95 * len(delays_ms))], 1)
            if delays_ms
            else None,
            "verdict_ms_worst": round(delays_ms[-1], 1) if delays_ms else None,
            "verdicts_later_than_150_ms": sum(delay > LATEST_MS for delay in delays_ms),
            "live_view_hz": None if live_hz is None else round(live_hz, 1),
            "lost": lost[-1].strip() if lost else "unknown",
            "load_average": os.getloadavg(),
        }
    print(json.dumps(found, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
