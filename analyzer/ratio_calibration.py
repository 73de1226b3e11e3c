"""Ratio calibration: hammer and accelerometer together, on a mass that is known.

A rigid mass hung freely and hit through its centre moves by a = F / m at every frequency, so the
measured ratio of the two signals, times the mass, is the one number by which the pair is wrong.
It is the number that scales every FRF; neither sensitivity need be known by itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.modal.spectra import HitSpectra
from armodal.protocols.errors import EstimateError

__all__ = ["RatioCalibration", "ratio_calibration"]

LEAST_FORCE = 0.3  # of the force spectrum's maximum: lines on which the noise hardly counts


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioCalibration:
    """The measured accelerance times the mass; 1 where both sensitivities are right.

    `ratio_std` has the scatter of the hits and the uncertainty of the mass; it is infinite with
    one hit. `unevenness` is the largest deviation over the lines used, relative: a mass that is
    not rigid, not free or not hit through its centre shows there.
    """

    ratio: float
    ratio_std: float
    unevenness: float
    n_hits: int
    axis: int  # the response that lies along the hit


def ratio_calibration(
    spectra: HitSpectra, mass_kg: float, *, mass_std_kg: float = 0.0
) -> RatioCalibration:
    """Estimate the ratio from hits on a known mass.

    Parameters
    ----------
    spectra
        Of the hits; response in m/s² times s. The axis with the largest response is taken.
    mass_kg
        Of all that moves, the sensor included.

    Raises
    ------
    EstimateError
        If the mass is not positive, or no line carries force.

    References
    ----------
    McConnell and Varoto, Vibration Testing: Theory and Practice, 2nd ed. (2008), ch. 7: mass
    calibration of hammer and accelerometer as one system.
    """
    if not mass_kg > 0.0:
        raise EstimateError(f"the mass of a ratio calibration: wanted above 0 kg, got {mass_kg}")
    power = np.abs(spectra.force) ** 2
    typical = np.sqrt(np.median(power, axis=0))
    lines = typical > LEAST_FORCE * typical.max()
    if not lines.any():
        raise EstimateError("no line carries force: were these hits?")
    axis = int(np.argmax(np.sum(np.abs(spectra.response[..., lines]) ** 2, axis=(0, 2))))
    force, response = spectra.force[:, lines], spectra.response[:, axis, :][:, lines]
    weight = np.sum(np.abs(force) ** 2, axis=1)
    per_hit = mass_kg * np.abs(np.sum(response * force.conj(), axis=1)) / weight
    every = np.sum(response * force.conj(), axis=0) / np.sum(np.abs(force) ** 2, axis=0)
    ratio = float(per_hit.mean())
    n = len(per_hit)
    scatter = float(per_hit.std(ddof=1)) / math.sqrt(n) if n > 1 else math.inf
    return RatioCalibration(
        ratio=ratio,
        ratio_std=math.hypot(scatter, ratio * mass_std_kg / mass_kg),
        unevenness=float(np.abs(mass_kg * np.abs(every) / ratio - 1.0).max()),
        n_hits=n,
        axis=axis,
    )
