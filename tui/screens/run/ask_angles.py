"""Ask for the joint angles that the operator has read, where no device tells them."""

from __future__ import annotations

import math
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

__all__ = ["AnglesScreen"]


class AnglesScreen(ModalScreen[tuple[float, ...] | None]):
    """As many numbers as the arm has joints, in degrees."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "Back")]

    def __init__(self, n_joints: int) -> None:
        super().__init__()
        self._n_joints = n_joints

    def compose(self) -> ComposeResult:
        """The words and the field."""
        with Vertical(id="angles"):
            yield Static(
                f"The {self._n_joints} joint angles that you read, in degrees, joint 1 first. "
                "Enter confirms that the arm is in this posture and held; Escape: back."
            )
            yield Input(placeholder="for instance -25.1 90 0 0 89.9 0")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Hand the angles on, if they are as many numbers as wanted."""
        try:
            degrees = tuple(float(part) for part in event.value.replace(",", " ").split())
        except ValueError:
            degrees = ()
        if len(degrees) != self._n_joints or not all(map(math.isfinite, degrees)):
            self.notify(f"wanted {self._n_joints} numbers in degrees", severity="error")
            return
        self.dismiss(degrees)
