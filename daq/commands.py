"""What the operator, or whoever acts for him, can tell the acquisition process."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Command", "Ready", "Retake", "Skip", "Stop"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """Sensor and hammer are at their points; hits count from now on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Skip:
    """Leave the point in hand without its hits."""

    reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Retake:
    """Begin the point in hand anew, or another one of the plan."""

    posture: str | None = None
    point: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """End the session; it can be resumed."""

    reason: str = "stopped by the operator"


Command = Ready | Skip | Retake | Stop
