"""What a screen is left for: where the app goes on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from armodal.protocols.arm.records import Arm

__all__ = ["Demonstrate", "GoHome", "Look", "Measure", "OwnArm", "Wish"]


@dataclass(frozen=True, slots=True, kw_only=True)
class GoHome:
    """The home screen, which says why something came to nothing, or that an arm file was made."""

    said: str = ""
    arm_made: Path | None = None  # what a new session is begun with next


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """The review of a session file; its gap result where it is not beside it."""

    session: Path
    gap: Path | None = None
    band_hz: tuple[float, float] | None = None  # None: the lines that carry a signal


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """A session to measure, or to go on with: its journal is there already."""

    journal: Path
    arm: str | Arm  # file, shipped name, or the arm itself
    plan: str | None  # None: as the journal has it
    simulated: bool
    measured_by: str = ""
    earlier: Path | None = None  # session of the same arm, whose paths may be measured back


@dataclass(frozen=True, slots=True, kw_only=True)
class Demonstrate:
    """The whole test in the simulated laboratory, without a hand at work."""

    folder: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnArm:
    """An arm file of a robot description, for which some things are asked in the terminal."""

    description: Path
    folder: Path  # where the arm's folder goes


Wish = GoHome | Look | Measure | Demonstrate | OwnArm
