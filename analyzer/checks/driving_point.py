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
import scipy

from armodal.analyzer.checks.records import Fault, Finding, Outcome
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["driving_point"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DERIVATIVE = {FrfForm.RECEPTANCE: 1, FrfForm.MOBILITY: 0, FrfForm.ACCELERANCE: -1}
_BAND_HZ = (8.0, 200.0)
_TOLERANCE = 0.05  # of the point's whole motion: aim and tilt mix in what is across the hit
_CLEAR = 5.0  # standard deviations: some 250 lines are looked at
_PROMINENCE = 0.3  # of a peak's height


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
    hole = not frf.measured[rows, reference].all()
    if not rows or hole or np.linalg.norm(axes.T @ along - at.direction) > _TOLERANCE:
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
    axis_size = np.abs(factor) * np.sqrt(np.sum(np.abs(frf.values[rows, reference]) ** 2, axis=0))
    keep = (frf.freq_hz >= _BAND_HZ[0]) & (frf.freq_hz <= _BAND_HZ[1])
    Y, limit = Y[keep], (_CLEAR * std / np.sqrt(2.0) + _TOLERANCE * axis_size)[keep]
    # A resonance is a peak of the real part, up or down, that stands well out of all errors.
    peaks = np.sort(np.concatenate([_peaks(Y.real, limit), _peaks(-Y.real, limit)]))
    up, down = Y.real[peaks] > 0.0, Y.real[peaks] < 0.0
    share = np.abs(Y.real[peaks]) / max(float(np.abs(Y.real[peaks]).sum()), 1e-300)
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
            f"all {n_up} clear resonances take energy; {_between(Y, peaks)}",
        )
    if n_up == 0 or float(share[up].sum()) < _TOLERANCE:
        return say(
            Outcome.FAULT,
            Fault.SIGN_FLIPPED,
            confidence,
            f"all {n_down} clear resonances give energy: "
            "the polarity of sensor or hammer is reversed",
        )
    return say(
        Outcome.FAULT,
        Fault.NOT_A_DRIVING_POINT,
        confidence,
        f"resonances near {frequencies} Hz give energy while {n_up} others take it: an axis of "
        "the sensor, its point, or the direction of the hit is not what it is said to be",
    )


def _peaks(height: Array, limit: Array) -> npt.NDArray[np.intp]:
    """Local maxima above the limit that are not ripples on the side of another."""
    found, properties = scipy.signal.find_peaks(height, height=limit, prominence=0.0)
    clear: npt.NDArray[np.intp] = found[properties["prominences"] > _PROMINENCE * height[found]]
    return clear


def _between(Y: ComplexArray, peaks: npt.NDArray[np.intp]) -> str:
    """How many neighbouring peaks have a minimum between them where the phase rises."""
    phase = np.unwrap(np.angle(Y))
    rising = 0
    for a, b in pairwise(peaks):
        least = a + int(np.argmin(np.abs(Y[a : b + 1])))
        low, high = max(least - 2, a), min(least + 2, b)
        rising += bool(phase[high] > phase[low])
    return f"anti-resonances between {rising} of {max(len(peaks) - 1, 0)} neighbouring pairs"
