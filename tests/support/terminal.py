"""A real terminal to test in: tmux, its keys and its screen."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from support.at_the_end import at_the_end

ROOT = Path(__file__).parents[2]
LOOK_EVERY_S = 0.05
PATIENCE = 4.0  # times what a quiet machine needs at most; a loaded one stalls for seconds


class Terminal:
    """A program in a tmux session of its own server; leaving the context ends both.

    So does the end of this process.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        columns: int = 120,
        rows: int = 36,
        env: Mapping[str, str] | None = None,
    ) -> None:
        home = tempfile.mkdtemp(prefix="tmux-")
        self._socket = str(Path(home) / "s")
        self._end = ExitStack()
        kill, remove = ["tmux", "-S", self._socket, "kill-server"], ["rm", "-rf", home]
        end = f"{shlex.join(kill)} 2> /dev/null; {shlex.join(remove)}"
        self._end.enter_context(at_the_end(end))
        words = {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT), **(env or {})}
        setting = " ".join(f"{name}={shlex.quote(value)}" for name, value in words.items())
        # The shell stays, so that what the program has said last can still be read.
        line = f"cd {shlex.quote(str(ROOT))}; {setting} {shlex.join(command)}; echo ended $?; cat"
        self._tmux(
            "-f", "/dev/null", "new-session", "-d", "-x", str(columns), "-y", str(rows), line
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def keys(self, *keys: str) -> None:
        """Press keys, by tmux's names."""
        self._tmux("send-keys", *keys)

    def screen(self) -> str:
        """Return what is on the screen."""
        return self._tmux("capture-pane", "-p")

    def record_to(self, path: Path) -> None:
        """Write all that the program sends to a file, or pipe, as it comes."""
        self._tmux("pipe-pane", f"exec cat > {shlex.quote(str(path))}")

    def program_pid(self) -> int:
        """Return the process id of the program."""
        shell = self._tmux("display-message", "-p", "#{pane_pid}").strip()
        children = Path(f"/proc/{shell}/task/{shell}/children").read_text(encoding="ascii")
        return int(children.split()[0])

    def until(self, pattern: str, timeout_s: float = 30.0, *also: str) -> str:
        """Wait until the screen shows a pattern, and others with it; return the screen.

        A screen is drawn piece by piece: what belongs together need not be there at once.
        """
        end_s = time.monotonic() + PATIENCE * timeout_s
        while True:
            screen = self.screen()
            missing = [each for each in (pattern, *also) if not re.search(each, screen)]
            if not missing:
                return screen
            if time.monotonic() > end_s:
                raise AssertionError(
                    f"{missing} did not come in {PATIENCE * timeout_s:g} s:\n{screen}"
                )
            time.sleep(LOOK_EVERY_S)

    def close(self) -> None:
        """End the program and its terminal."""
        self._end.close()

    def _tmux(self, *words: str) -> str:
        done = subprocess.run(
            ["tmux", "-S", self._socket, *words], check=True, capture_output=True, text=True
        )
        return done.stdout


def armodal(*words: str) -> list[str]:
    """Return the command line of an armodal command of this checkout."""
    return [sys.executable, "-m", "armodal.tui.cli", *words]
