"""Where a recorded force pulse begins, and which sign it has."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["TURNED", "pulse_onset", "pulse_polarity"]

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
