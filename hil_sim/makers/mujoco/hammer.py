"""What a hand with a hammer does: pulses, aim, place, start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.mujoco.ordinary import Bench

__all__ = ["Blow", "blow", "force_n", "missed"]

Streams = Callable[..., np.random.Generator]

PEAK_SCATTER = 0.12  # of ln of the peak about the wanted one
HARD_IS_SHORT = 0.09  # a contact of Hertz's: duration falls with the 1/5 power of speed, less here
LENGTH_SCATTER = 0.06


@dataclass(frozen=True, slots=True, kw_only=True)
class Blow:
    """One swing."""

    peak_n: float
    length_s: float
    lean: float  # how much sooner than midway the peak comes, of the half length
    direction: Array  # (3,) unit, base frame
    off_m: Array  # (3,) from the point, base frame
    late_samples: float  # after the trigger's sample


def blow(bench: Bench, streams: Streams, wanted_n: float, middle_n: float, aimed: Array) -> Blow:
    """Swing at a point along a wanted direction."""
    peak = wanted_n * np.exp(PEAK_SCATTER * streams("peak").uniform(-1.5, 1.5))
    length = bench.pulse_s * (peak / middle_n) ** -HARD_IS_SHORT
    off = bench.blow_m * streams("place").standard_normal(3)
    direction = missed(aimed, bench.aim_rad, streams("aim"))
    return Blow(
        peak_n=float(peak),
        length_s=float(length * np.exp(LENGTH_SCATTER * streams("length").standard_normal())),
        lean=float(streams("lean").uniform(0.05, 0.3)),
        direction=direction,
        off_m=off - direction * (off @ direction),
        late_samples=float(streams("start").uniform(-1.0, 0.0)),
    )


def missed(wanted: Array, spread_rad: float, rng: np.random.Generator) -> Array:
    """Turn a direction by an angle about each axis across it."""
    across = np.linalg.svd(wanted[None, :])[2][1:]
    result = wanted + spread_rad * rng.standard_normal(2) @ across
    return np.asarray(result / np.linalg.norm(result))


def force_n(swing: Blow, rate_hz: float, samples: int, start_s: float) -> Array:
    """Contact force over time: a half sine to the 3/2, as a Hertzian contact has it, leaning.

    Johnson, Contact Mechanics, section 11.4: the force is close to sin^(3/2).
    """
    t = (np.arange(samples) / rate_hz - start_s) / swing.length_s
    inside = (t > 0.0) & (t < 1.0)
    phase = np.where(inside, t, 0.0)
    bent = phase + swing.lean * phase * (1.0 - phase)  # sooner up than down
    return np.asarray(swing.peak_n * np.sin(np.pi * bent) ** 1.5 * inside)
