"""Pictures beside the words: the arm with its point, live levels, pulse, FRF."""

from __future__ import annotations

from rich.text import Text

from tui.run.state import RunState

__all__ = ["HitPictures", "point_picture"]


def point_picture(state: RunState, width: int, height: int) -> Text:
    """Return the arm."""
    return Text("")


class HitPictures:
    """Pictures of the hit screen, kept as long as what they show has not changed."""

    def live(self, state: RunState, width: int, height: int) -> Text:
        return Text("")

    def pulse(self, state: RunState, width: int, height: int) -> Text:
        return Text("")

    def frf(self, state: RunState, width: int, height: int) -> Text:
        return Text("")
