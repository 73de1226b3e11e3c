"""Cross products as matrices, and frames about an axis."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = ["across", "skew"]

Array = npt.NDArray[np.float64]

# v @ _CROSS holds the nine entries of the matrix of v x.
_CROSS = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
)


def skew(v: Array) -> Array:
    """Return the matrices (..., 3, 3) of v x, v (..., 3)."""
    return np.asarray((v @ _CROSS).reshape(*np.shape(v)[:-1], 3, 3))


def across(axis: Array) -> Array:
    """Return (3, 2) two unit vectors that complete a unit axis to a frame."""
    return _across(tuple(axis.tolist()))


@lru_cache(maxsize=1024)
def _across(of: tuple[float, ...]) -> Array:
    axis = np.array(of)
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, helper)
    first = first / np.linalg.norm(first)
    return frozen_array(np.stack([first, np.cross(axis, first)], axis=1), np.float64)
