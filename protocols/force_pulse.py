"""Where a recorded force pulse begins, which sign it has, and how wide it is."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["TURNED", "half_width", "pulse_onset", "pulse_polarity"]

TURNED = (
    "the hammer's polarity is reversed, a push reads negative; its force is turned, so that FRFs "
    "have it positive along the direction of the hit"
)
_ONSET_SHARE = 0.05  # of the peak force: where the pulse begins
_SWING = 0.5  # force the other way, over the peak: all that a converter's filter makes


def pulse_onset(force: npt.ArrayLike) -> int:
    """Return the sample at which a force first reaches a twentieth of its largest magnitude.

    Parameters
    ----------
    force
        (n,) about zero between pulses, any unit and sign.

    Examples
    --------
    >>> pulse_onset([0.0, 0.1, -5.0, -90.0, -40.0])
    2
    """
    size = np.abs(np.asarray(force, dtype=np.float64))
    return int(np.argmax(size >= _ONSET_SHARE * size.max()))


def pulse_polarity(force: npt.ArrayLike, usual: int = 1) -> int:
    """Return the sign of a force's pulses: the usual one unless the other is clearly larger.

    A hammer only pushes. What a filter or AC coupling makes of its pulse swings the other way by
    less than half of it; a force that swings both ways alike is no pulse, and keeps the usual sign.

    >>> pulse_polarity([0.0, -80.0, 10.0]), pulse_polarity([0.0, -80.0, 70.0])
    (-1, 1)
    """
    signed = usual * np.asarray(force, dtype=np.float64)
    along, against = float(signed.max(initial=0.0)), -float(signed.min(initial=0.0))
    return -usual if along < _SWING * against else usual


def half_width(force: npt.NDArray[np.float64], peak_at: int) -> float:
    """Return the full width of a pulse at half its peak in samples, by straight lines.

    Parameters
    ----------
    force
        (n,) positive along the push, any unit.
    peak_at
        Sample of the peak.

    Returns
    -------
    NaN where the record cuts the pulse off.

    Examples
    --------
    >>> half_width(np.array([0.0, 0.0, 10.0, 0.0, 0.0]), 2)
    1.0
    """
    half = 0.5 * force[peak_at]
    below = np.flatnonzero(force < half)
    i = int(np.searchsorted(below, peak_at)) - 1
    if half <= 0.0 or i < 0 or i + 1 >= len(below):
        return float("nan")
    left, right = int(below[i]), int(below[i + 1])
    rise = left + (half - force[left]) / (force[left + 1] - force[left])
    fall = right - (half - force[right]) / (force[right - 1] - force[right])
    return float(fall - rise)
