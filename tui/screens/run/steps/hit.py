"""Hit: verdict, hits left, craft, live envelope, last pulse, FRF and coherence."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Horizontal

from armodal.tui.screens.run.operator_screen import OperatorScreen
from armodal.tui.screens.run.pictures import HitPictures, live_picture
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.step_screen import Pane, StepScreen
from armodal.tui.screens.run.views.hit import left_text, verdict_text

__all__ = ["SCREEN", "HitScreen"]


class HitScreen(StepScreen):
    """The hammer is used."""

    def __init__(self) -> None:
        super().__init__()
        self._pictures = HitPictures()

    def body(self) -> ComposeResult:
        """Verdict on top, live view in the middle, what was measured below."""
        with Horizontal(id="verdict-row"):
            yield Pane(id="verdict")
            yield Pane(id="left")
        yield Pane(id="craft")
        with Horizontal(id="live"):
            yield Pane(id="force")
            yield Pane(id="acceleration")
        with Horizontal(id="measured"):
            yield Pane(id="pulse")
            yield Pane(id="frf")

    def draw(self, state: RunState) -> None:
        """Fill the panes; the verdict first, it is what the operator waits for."""
        high = self.size.height >= 38
        self.widget("verdict-row").styles.height = 8 if high else 6
        self.widget("craft").styles.height = 3 if high else 1
        self.widget("live").styles.height = max((self.size.height - (8 if high else 6) - 3) // 3, 5)
        width = self.pane("verdict").room[0]
        self.pane("verdict").show(verdict_text(state, width, 8 if high else 6))
        self.pane("left").show(left_text(state, self.pane("left").room[0], 5))
        self.pictures_later()

    def draw_pictures(self, state: RunState) -> None:
        """Draw what takes longer than words."""
        self.pane("craft").show(self._pictures.craft(state, *self.pane("craft").room, state.here))
        self.pane("pulse").show(self._pictures.pulse(state, *self.pane("pulse").room))
        self.pane("frf").show(self._pictures.frf(state, *self.pane("frf").room, state.here))
        for name in ("force", "acceleration"):
            self.pane(name).show(live_picture(state, *self.pane(name).room, name))

    def brief(self, state: RunState) -> Text:
        """Return the verdict alone."""
        return verdict_text(state, self.size.width - 2, 4)


SCREEN = OperatorScreen(make=HitScreen, needed=lambda _: True, place=50)
