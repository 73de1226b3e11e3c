"""Records of a test plan: what is to be measured, in which order."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.protocols.frf_records import FrfEstimator

__all__ = [
    "Averaging",
    "KnownMass",
    "Mode",
    "Plan",
    "PlannedPosture",
    "Sampling",
    "SensorOnArm",
    "Trigger",
    "Windows",
]


class Mode(StrEnum):
    """What moves from point to point."""

    ROVING_RESPONSE = "roving-response"
    ROVING_HAMMER = "roving-hammer"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """Sampling of one hit; the pre-trigger is part of the block."""

    rate_hz: Fraction
    samples: int
    pretrigger: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Trigger:
    """Level on the force channel."""

    level_n: float
    rising: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Windows:
    """Windows the analysis applies.

    `exponential_end` is the value at the record's end of the exponential that multiplies force
    and response alike (1 is none); `force_s` the length kept of the force record (None keeps it
    all).
    """

    exponential_end: float
    force_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Averaging:
    """How the hits of a point become one FRF.

    Hits unlike the others are left out in any case; `keep_hits` is how many of the like ones are
    averaged at most (None: all).
    """

    estimator: FrfEstimator = FrfEstimator.H1
    keep_hits: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorOnArm:
    """The roving (or fixed) accelerometer as a mass on the arm."""

    mass_kg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownMass:
    """A body that the laboratory bolts on, small beside its lever."""

    link: str
    mass_kg: float
    center_m: npt.NDArray[np.float64]  # (3,) link frame


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedPosture:
    """One posture: joint angles to reach, and the points to measure there, in order."""

    name: str
    joints_rad: npt.NDArray[np.float64]  # (n_joints,)
    tolerance_rad: float
    points: tuple[str, ...]
    hit_direction: npt.NDArray[np.float64] | None  # (3,) unit, base frame; None: minus sensor z
    validation: bool  # predicted from the others, never fitted
    brakes: bool = False  # on: no servo gives way, transmissions do
    known_mass: KnownMass | None = None
    peaks_n: tuple[float, ...] = ()  # wanted of a point's hits, in turn; empty: as they come

    def peak_wanted_n(self, accepted: int) -> float | None:
        """Return the peak force wanted of the next hit; None where any will do."""
        return self.peaks_n[accepted % len(self.peaks_n)] if self.peaks_n else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A test plan.

    In roving-response the hammer hits `fixed_point`; in roving-hammer the sensor sits there.
    """

    name: str
    arm: str
    mode: Mode
    fixed_point: str
    hits_per_point: int
    max_attempts: int  # hits tried at a point before the session says so
    sampling: Sampling
    trigger: Trigger
    windows: Windows
    sensor: SensorOnArm
    postures: tuple[PlannedPosture, ...]
    text: str
    sha256: str
    averaging: Averaging = Averaging()
