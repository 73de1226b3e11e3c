"""Point: the arm as it stands, the point marked, the sensor's axes as they must lie."""

from __future__ import annotations

import math
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical

from armodal.daq.session_machine import PromptKind
from armodal.tui.screens.run.operator_screen import OperatorScreen
from armodal.tui.screens.run.overview import roving_place
from armodal.tui.screens.run.pictures import HitPictures, point_picture
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.step_screen import Pane, StepScreen
from armodal.tui.screens.run.views.hit import last_hit_text
from armodal.tui.screens.run.views.point import last_verdict_text, point_text
from armodal.tui.screens.run.words import what_to_do

__all__ = ["SCREEN", "PointScreen"]

TURN_RAD = math.radians(15.0)


class PointScreen(StepScreen):
    """Sensor and hammer go to their points."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "turn(-1)", "Turn", key_display="←→"),
        Binding("right", "turn(1)", "Turn picture", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self._turned_rad = 0.0
        self._pictures = HitPictures()

    def body(self) -> ComposeResult:
        """The picture, and what to do."""
        with Horizontal(id="point"):
            yield Pane(id="arm")
            with Vertical(id="beside"):
                yield Pane(id="instructions")
                yield Pane(id="last-verdict")
                yield Pane(id="last-frf")
        yield Pane(id="last-craft")

    def draw(self, state: RunState) -> None:
        """Fill the panes."""
        beside = self.widget("beside").content_size.width
        self.widget("last-craft").styles.height = 0 if state.last_hit is None else 1
        self.pane("instructions").show(point_text(state, beside))
        self.pane("last-verdict").show(last_verdict_text(state, beside))
        self.pictures_later()

    def draw_pictures(self, state: RunState) -> None:
        """Draw what takes longer than words."""
        size = self.pane("arm").room
        self.pane("arm").show(point_picture(state, *size, turned_rad=self._turned_rad))
        judged = state.last_hit
        place = None if judged is None else roving_place(state, judged.hit)
        frf = self.pane("last-frf")
        frf.show(self._pictures.frf(state, *frf.room, place))
        craft = self.pane("last-craft")
        craft.show(self._pictures.craft(state, *craft.room, place))

    def action_turn(self, way: int) -> None:
        """Walk around the arm in the picture."""
        self._turned_rad += way * TURN_RAD
        self.again()

    def brief(self, state: RunState) -> Text:
        """Return what to do, and the verdict on the hit before."""
        return (
            Text().append(f"{what_to_do(state)}\n", style="bold").append_text(last_hit_text(state))
        )


def _needed(state: RunState) -> bool:
    return state.prompt is not None and state.prompt.kind is PromptKind.POINT


SCREEN = OperatorScreen(make=PointScreen, needed=_needed, place=40)
