"""The hand that swings the hammer: half-sine pulses of a person's force, width and aim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant_file import HandTruth
from armodal.protocols.arrays import frozen_array

__all__ = ["Blow", "Pulse", "blow", "hand_at"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulse:
    """One half sine of force."""

    delay_s: float  # after the blow's beginning
    peak_n: float
    width_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Blow:
    """One swing: where and along what it truly landed, and its pulses."""

    point_id: str
    offset_m: Array  # (3,) from the test point, base axes
    direction: Array  # (3,) unit, base axes, of the force on the arm
    kind: str  # "good", "double", "soft" or "overload"
    pulses: tuple[Pulse, ...]
    free_mass_kg: float | None = None  # a mass with the sensor on it is hit, not the arm


_HIT_OR_MISS = 1.1  # a person who wants a level reaches it to about this factor


def hand_at(hand: HandTruth, peak_n: float | None) -> HandTruth:
    """Return a hand whose good hits are about as hard as wanted, None: as it does by itself."""
    if peak_n is None:
        return hand
    around = (peak_n / _HIT_OR_MISS, peak_n * _HIT_OR_MISS)
    return hand.model_copy(update={"peak_n": around})


def blow(
    hand: HandTruth, rng: np.random.Generator, point_id: str, direction: npt.ArrayLike
) -> Blow:
    """Swing once at a point along a wanted direction.

    Good hits have a peak drawn log-uniformly and a width drawn uniformly; the aim misses by
    normal amounts along the two axes across the wanted direction.
    """
    wanted = np.asarray(direction, dtype=np.float64)
    wanted = wanted / np.linalg.norm(wanted)
    across = np.linalg.svd(wanted[None, :])[2][1:]
    miss = np.deg2rad(hand.direction_std_deg) * rng.standard_normal(2) @ across
    true_direction = (wanted + miss) / np.linalg.norm(wanted + miss)
    offset = hand.position_std_m * rng.standard_normal(2) @ across

    fate = float(rng.random())
    width_s = float(rng.uniform(*hand.width_s))
    peak_n = float(np.exp(rng.uniform(*np.log(hand.peak_n))))
    kind = "good"
    extra: tuple[Pulse, ...] = ()
    if fate < hand.double_probability:
        kind = "double"
        extra = (
            Pulse(
                delay_s=width_s + float(rng.uniform(*hand.double_delay_s)),
                peak_n=peak_n * float(rng.uniform(*hand.double_ratio)),
                width_s=width_s,
            ),
        )
    elif fate < hand.double_probability + hand.soft_probability:
        kind, peak_n = "soft", float(rng.uniform(*hand.soft_peak_n))
    elif fate < hand.double_probability + hand.soft_probability + hand.overload_probability:
        kind, peak_n = "overload", float(rng.uniform(*hand.overload_peak_n))
    return Blow(
        point_id=point_id,
        offset_m=frozen_array(offset, np.float64),
        direction=frozen_array(true_direction, np.float64),
        kind=kind,
        pulses=(Pulse(delay_s=0.0, peak_n=peak_n, width_s=width_s), *extra),
    )
