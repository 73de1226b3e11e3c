"""The least point of a convex quadratic within bounds."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["least_in_box"]

Array = npt.NDArray[np.float64]

_PATIENCE = 3  # exchanges of all that is wrong without fewer wrong, before one at a time
_MOST = 200


def least_in_box(A: Array, b: Array, low: Array, high: Array) -> Array:
    """Least x'Ax / 2 + b'x with low <= x <= high, for a positive definite A (n, n).

    By principal pivoting: each element is free or at a bound. Free ones beyond a bound go to it,
    those at a bound whose slope points inward become free, all at once; one at a time where that
    goes round in circles, which ends; after 200 exchanges with what there is, within the bounds.

    References
    ----------
    Judice and Pires, Computers Oper. Res. 21 (1994) 587.
    """
    x = np.zeros_like(b)
    at_low, at_high = np.zeros(len(b), dtype=bool), np.zeros(len(b), dtype=bool)
    fewest, patience = len(b) + 1, _PATIENCE
    for _ in range(_MOST):
        free = ~(at_low | at_high)
        x = np.where(at_low, low, np.where(at_high, high, 0.0))
        x[free] = np.linalg.solve(A[np.ix_(free, free)], -(b + A @ x)[free])
        slope = A @ x + b
        below, above = free & (x < low), free & (x > high)
        inward = (at_low & (slope < 0.0)) | (at_high & (slope > 0.0))
        wrong = below | above | inward
        n_wrong = int(wrong.sum())
        if n_wrong == 0:
            break
        if n_wrong < fewest:
            fewest, patience = n_wrong, _PATIENCE
        else:
            patience -= 1
        if patience < 0:
            wrong = np.arange(len(b)) == np.flatnonzero(wrong)[-1]
        at_low = np.where(wrong, below, at_low)
        at_high = np.where(wrong, above, at_high)
    return np.asarray(np.clip(x, low, high))
