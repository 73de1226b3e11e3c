"""Point: the arm as it stands, the point marked, the sensor's axes as they must lie."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Horizontal

from tui.run.pictures import point_picture
from tui.run.screens.step import Pane, StepScreen
from tui.run.state import RunState
from tui.run.views.point import point_text
from tui.run.words import what_to_do

__all__ = ["PointScreen"]


class PointScreen(StepScreen):
    """Sensor and hammer go to their points."""

    def body(self) -> ComposeResult:
        """The picture, and what to do."""
        with Horizontal(id="point"):
            yield Pane(id="arm")
            yield Pane(id="instructions")

    def draw(self, state: RunState) -> None:
        """Fill the panes."""
        width, height = self.pane("arm").room
        self.pane("arm").show(point_picture(state, width, height))
        self.pane("instructions").show(point_text(state, self.pane("instructions").room[0]))

    def brief(self, state: RunState) -> Text:
        """Return what to do, in one line."""
        return Text(what_to_do(state), style="bold")
