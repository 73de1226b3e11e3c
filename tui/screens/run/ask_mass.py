"""Ask for the known mass of a ratio calibration."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.validation import Number
from textual.widgets import Input, Static

__all__ = ["MassScreen"]

LEAST_KG, MOST_KG = 0.01, 100.0
WORDS = (
    "Known mass in kg, the sensor included. Hang it freely, put the sensor on it, hit it opposite "
    "the sensor through its centre. Enter: hit it; Escape: back."
)


class MassScreen(ModalScreen[float | None]):
    """One number."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "Back")]

    def compose(self) -> ComposeResult:
        """The words and the field."""
        with Vertical(id="mass"):
            yield Static(WORDS)
            yield Input(
                placeholder="for instance 2.05",
                type="number",
                validators=[Number(minimum=LEAST_KG, maximum=MOST_KG)],
            )

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Hand the mass on, if it is one."""
        if event.validation_result is not None and not event.validation_result.is_valid:
            self.notify(f"wanted a mass from {LEAST_KG:g} to {MOST_KG:g} kg", severity="error")
            return
        self.dismiss(float(event.value))
