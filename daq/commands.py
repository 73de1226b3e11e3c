"""What the operator, or whoever acts for him, can tell the acquisition process."""

from __future__ import annotations

from dataclasses import dataclass

from armodal.protocols.arm.records import Point

__all__ = [
    "Command",
    "MovePoint",
    "Note",
    "Ready",
    "Retake",
    "Skip",
    "StatedPosture",
    "Stop",
    "TriggerLevel",
    "Withdraw",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """Sensor and hammer are at their points; hits count from now on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StatedPosture:
    """A person says that the arm stands at the posture asked for, and is held.

    `joints_rad` are the angles he has read, None where they are those of the plan.
    """

    joints_rad: tuple[float, ...] | None = None


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
    finish_hit: bool = False  # a hit that may be under way is waited for, judged and kept


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """Keep a sentence of the operator in the journal."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Withdraw:
    """Take back the last accepted hit; it stays in the journal, and counts no more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MovePoint:
    """A test point is elsewhere on its link than the arm file has it."""

    point: Point


@dataclass(frozen=True, slots=True, kw_only=True)
class TriggerLevel:
    """Before a session: set the board's trigger level for the next trial hits."""

    level_n: float


Command = Ready | Skip | Retake | Stop | Note | Withdraw | StatedPosture | TriggerLevel | MovePoint
