"""Driving-point check: where the hammer hits, the arm can only take energy, never give it.

The driving-point mobility Y(s) of a passive structure is positive real: Re Y(s) >= 0 for every s
with Re s >= 0. On s = j w this is the phase of the receptance within 0 to -180 degrees, and makes
an anti-resonance stand between any two resonances; on the shifted lines of an exponential window it
holds as it stands. A flipped sign (sensor or hammer) makes it negative everywhere; a sensor that is
somewhere else, or looks elsewhere, makes it negative at some resonances only.

References
----------
Brune, J. Math. Phys. 10 (1931) 191 (positive-real functions); Ewins, Modal Testing, 2nd ed. (2000),
section 2.8 (resonances and anti-resonances of a point FRF).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy import signal

from analyzer.checks.records import Fault, Finding, Outcome
from analyzer.modal.windows import laplace_lines
from protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["driving_point"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DERIVATIVE = {FrfForm.RECEPTANCE: 1, FrfForm.MOBILITY: 0, FrfForm.ACCELERANCE: -1}
_BAND_HZ = (8.0, 200.0)
_PROMINENCE_DB = 6.0
_TOLERANCE = 0.05  # of the magnitude: aim and tilt mix in motion across the hit
_CLEAR = 3.0  # standard deviations


def driving_point(frf: FrequencyResponse, reference: int = 0) -> Finding:
    """Check the sign and the phase of the FRF at the point that is hit, along the hit."""
    at = frf.references[reference]
    rows = [i for i, dof in enumerate(frf.responses) if dof.point == at.point]

    def say(outcome: Outcome, fault: Fault | None, confidence: float, text: str) -> Finding:
        named = outcome is Outcome.FAULT
        return Finding(
            check="driving point",
            posture=frf.posture,
            outcome=outcome,
            fault=fault if named else None,
            points=(at.point,) if named else (),
            everywhere=False,
            confidence=confidence,
            text=text,
        )

    axes = np.array([frf.responses[i].direction for i in rows]).reshape(-1, 3)
    along = np.linalg.pinv(axes.T) @ at.direction if rows else np.zeros(0)
    if not rows or np.linalg.norm(axes.T @ along - at.direction) > _TOLERANCE:
        return say(
            Outcome.CANNOT_TELL,
            None,
            0.0,
            f"point {at.point}, where the hammer hits, was not measured along the hit",
        )
    s = laplace_lines(frf.freq_hz, frf.decay_rad_s)
    factor = s ** _DERIVATIVE[frf.form]
    Y = factor * (along @ frf.values[rows, reference])
    std = np.abs(factor) * np.sqrt(along**2 @ frf.variance[rows, reference])
    keep = (frf.freq_hz >= _BAND_HZ[0]) & (frf.freq_hz <= _BAND_HZ[1])
    # A peak counts where it stands well out of the noise: its real part then is the mode's sign.
    level = 20.0 * np.log10(np.maximum(np.abs(Y[keep]), 1e-300))
    peaks, _ = signal.find_peaks(level, prominence=_PROMINENCE_DB)
    real, size, std = Y[keep].real[peaks], np.abs(Y[keep])[peaks], std[keep][peaks]
    limit = _CLEAR * std / np.sqrt(2.0) + _TOLERANCE * size
    up, down = real > limit, real < -limit
    # Each peak by its share of the squared response, so that a small one has a small say.
    share = size**2 / max(float((size**2).sum()), 1e-300)
    n_up, n_down = int(up.sum()), int(down.sum())
    frequencies = ", ".join(f"{f:.1f}" for f in frf.freq_hz[keep][peaks][down])
    confidence = float(1.0 - 0.5 ** (n_up + n_down)) if n_up + n_down else 0.0
    if n_up == 0 and n_down == 0:
        return say(Outcome.CANNOT_TELL, None, 0.0, "no resonance stands out of the noise")
    if n_down == 0:
        return say(
            Outcome.GOOD,
            None,
            confidence,
            f"all {n_up} clear resonances take energy; {_between(Y[keep], peaks)}",
        )
    if n_up == 0 or float(share[up].sum()) < _TOLERANCE:
        return say(
            Outcome.FAULT,
            Fault.SIGN_FLIPPED,
            confidence,
            f"all {n_down} clear resonances give energy: the sign of sensor or hammer is flipped",
        )
    return say(
        Outcome.FAULT,
        Fault.NOT_A_DRIVING_POINT,
        confidence,
        f"resonances near {frequencies} Hz give energy while {n_up} others take it: an axis of "
        "the sensor, its point, or the direction of the hit is not what it is said to be",
    )


def _between(Y: ComplexArray, peaks: npt.NDArray[np.intp]) -> str:
    """How many neighbouring peaks have a minimum between them where the phase rises."""
    phase = np.unwrap(np.angle(Y))
    rising = 0
    for a, b in pairwise(peaks):
        least = a + int(np.argmin(np.abs(Y[a : b + 1])))
        low, high = max(least - 2, a), min(least + 2, b)
        rising += bool(phase[high] > phase[low])
    return f"anti-resonances between {rising} of {max(len(peaks) - 1, 0)} neighbouring pairs"
