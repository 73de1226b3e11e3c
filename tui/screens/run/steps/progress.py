"""Progress: every point of every posture; the cursor jumps to any of them."""

from __future__ import annotations

from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.geometry import Region

from armodal.tui.screens.run.operator_screen import OperatorScreen
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.step_screen import Pane, StepScreen
from armodal.tui.screens.run.views.hit import last_hit_text
from armodal.tui.screens.run.views.progress import (
    cell_width,
    cursor_line,
    grid_text,
    left_line,
    outcome_text,
    summary_text,
)

__all__ = ["SCREEN", "ProgressScreen"]


class ProgressScreen(StepScreen):
    """Postures by points."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "move(-1)", "Choose", key_display="←→"),
        Binding("right", "move(1)", "Choose point", show=False),
        Binding("up", "row(-1)", "Choose point", show=False),
        Binding("down", "row(1)", "Choose point", show=False),
        Binding("pageup", "page(-1)", "Up", show=False),
        Binding("pagedown", "page(1)", "Down", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self.cursor = -1  # index into the plan's points; -1 while nothing was chosen
        self._n = 0

    def body(self) -> ComposeResult:
        """Outcome, grid, summary."""
        with VerticalScroll(id="progress", can_focus=False):
            yield Pane(id="outcome")
            yield Pane(id="time-left")
            yield Pane(id="grid")
            yield Pane(id="summary")

    def draw(self, state: RunState) -> None:
        """Fill the panes."""
        self._n = len(state.progress)
        if self.cursor < 0 and state.here is not None:
            places = [(p.posture, p.point) for p in state.progress]
            self.cursor = places.index(state.here) if state.here in places else -1
        width = self.size.width - 4
        outcome = outcome_text(state, width)
        self.pane("outcome").display = bool(outcome.plain)
        self.pane("outcome").show(outcome)
        self.pane("time-left").show(left_line(state))
        self.pane("grid").show(grid_text(state, width, self.cursor))
        self.pane("summary").show(summary_text(state))

    def brief(self, state: RunState) -> Text:
        """Return how it ended, or what is left and the verdict on the hit before."""
        if state.phase in {Phase.FAILED, Phase.ENDED}:
            return outcome_text(state, self.size.width - 2)
        return left_line(state).append("\n").append_text(last_hit_text(state))

    def action_move(self, by: int) -> None:
        """Move the cursor by points."""
        if self._n:
            self.cursor = (max(self.cursor, 0) + by) % self._n
            self.again()
            self._keep_in_sight()

    def action_page(self, way: int) -> None:
        """Show what lies above or below."""
        area = self.widget("progress")
        area.scroll_relative(y=way * max(area.size.height - 2, 1), animate=False)

    def _keep_in_sight(self) -> None:
        if self._state is None:
            return
        grid = self.pane("grid")
        line = cursor_line(self._state, self.size.width - 4, self.cursor)
        cell = Region(0, grid.virtual_region.y + line - 1, 1, 3)
        self.widget("progress").scroll_to_region(cell, animate=False)

    def action_row(self, by: int) -> None:
        """Move the cursor by rows of the grid."""
        if self._state is not None:
            self.action_move(by * max((self.size.width - 4) // cell_width(self._state), 1))

    @property
    def chosen(self) -> tuple[str, str] | None:
        """Posture and point under the cursor."""
        if self._state is None or not 0 <= self.cursor < len(self._state.progress):
            return None
        place = self._state.progress[self.cursor]
        return place.posture, place.point


def _needed(state: RunState) -> bool:
    """Where there is nothing to be done at a posture."""
    stopped = state.phase in {Phase.FAILED, Phase.ENDED}
    return stopped or state.prompt is None or state.prompt.posture is None


SCREEN = OperatorScreen(make=ProgressScreen, needed=_needed, place=20, key="g", words="Grid")
