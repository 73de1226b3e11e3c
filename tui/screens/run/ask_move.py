"""Ask where the point in hand is, where it is not where the arm file has it."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from armodal.analyzer.own_arm.towards import joints_of_link
from armodal.protocols.arm.records import Arm

__all__ = ["MoveScreen"]


class MoveScreen(ModalScreen[str | None]):
    """An offset, a way towards a point or a joint, or three distances; all in mm."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "Back")]

    def __init__(self, arm: Arm, point_id: str) -> None:
        super().__init__()
        self._arm, self._point = arm, arm.point(point_id)

    def compose(self) -> ComposeResult:
        """The words and the field."""
        with Vertical(id="move"):
            yield Static(self._words(), markup=False)
            yield Input(placeholder="for instance 20 0")

    def _words(self) -> str:
        here, arm = self._point, self._arm
        others = [p for p in arm.points if p.link == here.link and p.id != here.id]
        near = sorted(others, key=lambda p: float(np.linalg.norm(p.position_m - here.position_m)))
        rows = [
            f"Point {here.id} on {here.link}: {_mm(here.position_m)} mm in the link's frame.",
            "Where is it instead? All in mm:",
            "  20 0                 along x and y as pictured",
        ]
        if near:
            rows.append(f"  {near[0].id + ':30':<20} 30 mm towards point {near[0].id}")
        for name in joints_of_link(arm, here.link):
            number = 1 + [joint.name for joint in arm.joints].index(name)
            rows.append(f"  {f'J{number}:30':<20} 30 mm towards the axis of {name}")
        if len(near) >= 3:
            three = " ".join(
                f"{p.id}:{1e3 * np.linalg.norm(p.position_m - here.position_m):.0f}"
                for p in near[:3]
            )
            rows.append(f"  {three:<20} as measured from three points")
        rows.append("Enter: move it, the journal keeps it; Escape: back.")
        return "\n".join(rows)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Hand the words on, if there are any."""
        if event.value.strip():
            self.dismiss(event.value)


def _mm(place_m: np.ndarray) -> str:
    return ", ".join(f"{1e3 * value + 0.0:.0f}" for value in place_m)
