"""What a program sends to its terminal, with the time: verdicts told, live views drawn."""

from __future__ import annotations

import re
import threading
import time
from itertools import pairwise
from pathlib import Path

RECORD = re.compile(rb"record[^0-9]{1,12}([0-9]+)")
ESCAPE = re.compile(rb"\x1b\[[0-9;?]*[a-zA-Z]")
MOVE = re.compile(rb"\x1b\[([0-9]+);[0-9]+H")
ONE_PAINT_S = 0.02  # a screen comes in several pieces
LIVE_TITLE = "force, live"
ROWS_LOOKED_AT = 4  # below the title: less than the live view ever has


class TerminalWatch(threading.Thread):
    """Listen to a terminal's output.

    Attributes
    ----------
    shown_s : dict
        When the verdict on each record was sent.
    """

    def __init__(self, fifo: Path) -> None:
        super().__init__(daemon=True)
        self._fifo = fifo
        self._live_rows = range(0)
        self._painted_s: list[float] = []
        self._looks: list[tuple[float, bool]] = []
        self.shown_s: dict[int, float] = {}

    def run(self) -> None:
        """Listen until the terminal is closed."""
        tail = b""
        with self._fifo.open("rb", buffering=0) as stream:
            while chunk := stream.read(65536):
                now_s = time.monotonic()
                told = tail + chunk
                # Escape sequences may stand between the words.
                for found in RECORD.finditer(ESCAPE.sub(b"", told)):
                    self.shown_s.setdefault(int(found.group(1)), now_s)
                rows = {int(row) - 1 for row in MOVE.findall(chunk)}
                if not rows.isdisjoint(self._live_rows):
                    self._painted_s.append(now_s)
                tail = chunk[-200:]

    def look(self, screen: str) -> None:
        """Note whether the live view is in sight; call it a few times a second."""
        at = next((i for i, line in enumerate(screen.splitlines()) if LIVE_TITLE in line), None)
        if at is not None:
            self._live_rows = range(at + 1, at + 1 + ROWS_LOOKED_AT)
        self._looks.append((time.monotonic(), at is not None))

    def live_view_hz(self) -> float | None:
        """Return how often a second the live view was drawn while in sight; None if never."""
        paints = [b for a, b in pairwise([0.0, *self._painted_s]) if b - a > ONE_PAINT_S]
        stretches = [(a, b) for (a, was), (b, still) in pairwise(self._looks) if was and still]
        seconds = sum(b - a for a, b in stretches)
        if not seconds:
            return None
        count = sum(any(a <= paint < b for a, b in stretches) for paint in paints)
        return count / seconds
