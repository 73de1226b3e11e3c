"""Loss factors as dampers: what simulators in time have in their place, and how far off it is."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.corrected.chain import Chain
from armodal.analyzer.corrected.correction import Correction
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import corrected_posture, stand

__all__ = ["AsDampers", "as_dampers"]

Array = npt.NDArray[np.float64]

_POSTURES, _SEED, _INSIDE = 20, 0, 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class AsDampers:
    """A chain without loss factors, and what that does to the modes compared."""

    chain: Chain
    at_hz: float
    f_error: float  # largest relative difference of a frequency
    damping_error: float  # largest difference of a damping ratio


def as_dampers(correction: Correction, chain: Chain, *, below_hz: float) -> AsDampers:
    """Put in the place of loss factors dampers that take as much at one frequency.

    A loss factor eta takes pi eta k A^2 an oscillation, a damper pi c omega A^2 (Ewins, Modal
    Testing, 2nd ed. (2000), section 2.4.3): c = eta k / omega. The frequency is the geometric mean
    of the modes below `below_hz`; the stiffness is that of the arm file, at 30 Hz.
    """
    low, high = np.array([j.range_rad for j in correction.ordinary.arm.joints]).T
    room = np.random.default_rng(_SEED).uniform(_INSIDE, 1.0 - _INSIDE, (_POSTURES, len(low)))
    own = [
        corrected_posture(correction, stand(correction, low + part * (high - low))) for part in room
    ]
    wanted = [corrected_modes(posture, below_hz=below_hz) for posture in own]
    every = np.concatenate([modes.f_hz for modes in wanted])
    at_hz = float(np.exp(np.mean(np.log(every))))
    omega = 2.0 * np.pi * at_hz
    f_error = damping_error = 0.0
    for posture, modes in zip(own, wanted, strict=True):
        damped = replace(
            posture,
            damping=posture.damping + posture.loss / omega,
            loss=np.zeros_like(posture.loss),
        )
        found = corrected_modes(damped, n_modes=len(modes.f_hz))
        f_error = max(f_error, float(np.abs(found.f_hz / modes.f_hz - 1.0).max()))
        damping_error = max(
            damping_error, float(np.abs(found.damping_ratio - modes.damping_ratio).max())
        )
    return AsDampers(
        chain=replace(
            chain, damping=chain.damping + chain.loss / omega, loss=np.zeros_like(chain.loss)
        ),
        at_hz=at_hz,
        f_error=f_error,
        damping_error=damping_error,
    )
