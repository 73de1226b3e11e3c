"""The progress of a scripted test in one line, in place of one a hit."""

from __future__ import annotations

from rich.console import Console
from rich.control import Control
from rich.segment import ControlType

from armodal.daq.events import Event, Finished, HitJudged

__all__ = ["HitCount"]

_SAME_LINE = Control(ControlType.CARRIAGE_RETURN, (ControlType.ERASE_IN_LINE, 2))


class HitCount:
    """Called with every event: on a terminal one line that changes, else one a posture."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._accepted = self._rejected = 0
        self._posture = ""

    def __call__(self, event: Event) -> None:
        """Take an event of the acquisition."""
        if isinstance(event, HitJudged):
            if self._posture not in {"", event.hit.posture} and not self._console.is_terminal:
                self._say()
            self._posture = event.hit.posture
            if event.hit.verdict.accepted:
                self._accepted += 1
            else:
                self._rejected += 1
            if self._console.is_terminal:
                self._say(end="")
        elif isinstance(event, Finished):
            self._say()

    def _say(self, end: str = "\n") -> None:
        if self._console.is_terminal:
            self._console.control(_SAME_LINE)
        counts = f"{self._accepted} hits accepted, {self._rejected} rejected so far"
        self._console.print(
            f"· {self._posture}: {counts}", style="dim", end=end, no_wrap=True, overflow="ellipsis"
        )
