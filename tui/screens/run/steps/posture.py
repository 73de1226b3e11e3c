"""Posture: joints now and wanted, in large figures."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult

from armodal.daq.session_machine import PromptKind
from armodal.tui.screens.run.operator_screen import OperatorScreen
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.step_screen import Pane, StepScreen
from armodal.tui.screens.run.views.hit import last_hit_text
from armodal.tui.screens.run.views.posture import joints_text, posture_word, word_text

__all__ = ["SCREEN", "PostureScreen"]

HIGH, MIDDLING = 38, 28  # rows of the window, from which the word is written larger


class PostureScreen(StepScreen):
    """The arm is brought to its posture, from outside its reach."""

    def body(self) -> ComposeResult:
        """The word, and the joints."""
        yield Pane(id="word")
        yield Pane(id="joints")

    def draw(self, state: RunState) -> None:
        """Fill the panes."""
        rows = 7 if self.size.height >= HIGH else 5 if self.size.height >= MIDDLING else 2
        self.widget("word").styles.height = rows
        width = self.size.width - 2
        letters = {7: 5, 5: 3, 2: 1}[rows]
        self.pane("word").show(word_text(state, width, letters))
        self.pane("joints").show(joints_text(state, width, self.size.height - rows - 3))

    def brief(self, state: RunState) -> Text:
        """Return the large word, small, and the verdict on the hit before."""
        word, style, _ = posture_word(state)
        return Text().append(f"{word}\n", style=style).append_text(last_hit_text(state))


def _needed(state: RunState) -> bool:
    """Until the arm stands in its posture, and the operator has said that it is safe."""
    prompt = state.prompt
    return (prompt is not None and prompt.kind is PromptKind.POSTURE) or not state.safe


SCREEN = OperatorScreen(make=PostureScreen, needed=_needed, place=30)
