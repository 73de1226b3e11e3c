"""Lab: ports, devices, sensors, levels, trial hits."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import VerticalScroll

from armodal.tui.screens.run.operator_screen import OperatorScreen
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.step_screen import Pane, StepScreen
from armodal.tui.screens.run.views.lab import devices_text, levels_text, next_step, trials_text
from armodal.tui.screens.run.views.parts import big

__all__ = ["SCREEN", "LabScreen"]


class LabScreen(StepScreen):
    """Before the session."""

    def body(self) -> ComposeResult:
        """Next step on top, then what is there."""
        yield Pane(id="next")
        with VerticalScroll(id="lab", can_focus=False):
            yield Pane(id="devices")
            yield Pane(id="levels")
            yield Pane(id="trials")

    def draw(self, state: RunState) -> None:
        """Fill the panes."""
        width = self.size.width - 4
        sentence, style = next_step(state)
        word = "LAB" if self.size.height >= 30 else ""
        text = big(word, "bold", width=width, height=3).append("\n") if word else Text()
        self.pane("next").show(text.append(sentence, style=style))
        self.pane("devices").show(devices_text(state))
        self.pane("levels").show(levels_text(state, width))
        self.pane("trials").show(trials_text(state))


def _needed(state: RunState) -> bool:
    """Until the session has said what is to be done first."""
    waits = state.phase is Phase.SESSION and state.prompt is None
    return waits or state.phase in {Phase.LAB, Phase.OPENING}


SCREEN = OperatorScreen(make=LabScreen, needed=_needed, place=10)
