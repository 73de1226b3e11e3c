"""How wide a pulse is at half its peak, which is what a hit's verdict tells."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["half_width"]


def half_width(force: npt.NDArray[np.float64]) -> float:
    """Return the full width at half the peak of samples (n,), in samples.

    By straight lines between samples; to the end of what is recorded where the pulse begins or
    ends beyond it.

    >>> half_width(np.array([0.0, 2.0, 4.0, 2.0, 0.0]))
    2.0
    """
    peak = int(np.argmax(force))
    half = 0.5 * float(force[peak])

    def reach(side: npt.NDArray[np.float64]) -> float:
        """Samples from the peak until half of it, outwards."""
        below = np.flatnonzero(side <= half)
        if not below.size:
            return len(side) - 1.0
        first = int(below[0])
        inner, outer = side[first - 1], side[first]
        return first - 1 + float((inner - half) / (inner - outer))

    return reach(force[peak:]) + reach(force[peak::-1])
