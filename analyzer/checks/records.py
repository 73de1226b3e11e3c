"""What a measurement check says: good, a named fault, or that it cannot tell."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Fault", "Finding", "Outcome"]


class Outcome(StrEnum):
    """Word of a check."""

    GOOD = "good"
    FAULT = "fault"
    CANNOT_TELL = "cannot tell"
    TO_KNOW = "to know"  # no fault of the measurement, and the analysis allows for it


class Fault(StrEnum):
    """Faults the checks have names for."""

    AXIS_SWAPPED = "axis swapped"
    SIGN_FLIPPED = "sign flipped"
    GAIN = "gain"
    WRONG_POINT = "wrong point"
    LEVEL_DEPENDENT = "level dependent"
    NOT_RECIPROCAL = "not reciprocal"
    NOT_A_DRIVING_POINT = "not a driving point"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One check of one posture.

    `points` names where the fault sits; empty together with `everywhere` means in the roving
    sensor, at all points. `confidence`, from 0 to 1, is of a fault the share of the likelihood that
    its name holds, of a good word how far the nearest fault stays below what would name it; it is 0
    where the check cannot tell. Neither counts faults the check does not know.
    """

    check: str
    posture: str
    outcome: Outcome
    fault: Fault | None
    points: tuple[str, ...]
    everywhere: bool
    confidence: float
    text: str
