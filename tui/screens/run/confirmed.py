"""What the operator confirmed before a session began, as sentences for its journal."""

from __future__ import annotations

from armodal.protocols.session.journal_payloads import CALIBRATION
from armodal.tui.screens.run.measured import active_channels
from armodal.tui.screens.run.sensitivity import sensitivity_words
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.words import off_words, ratio_words

__all__ = ["CONFIRMED", "confirmed_words"]

CONFIRMED = "the operator has confirmed:"


def confirmed_words(state: RunState) -> tuple[str, ...]:
    """Say which sensors are mounted, and what the known mass told of them."""
    said = []
    sensors = ", ".join(
        f"{c.name} {c.serial_number} of {sensitivity_words(c, state.input_range_v)}"
        for c in active_channels(state)
    )
    if sensors and state.sensors_confirmed:
        said.append(f"{CONFIRMED} the sensors mounted are {sensors}")
    if state.ratio is not None:
        said.append(
            f"{CALIBRATION}hammer and accelerometer on a known mass {ratio_words(state.ratio)}"
            f"; not applied, {off_words(state.ratio)}"
        )
    return tuple(said)
