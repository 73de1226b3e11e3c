"""Arrays whose last axis are lines: few long operations instead of many small ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["as_single", "inverses_of_three", "lines_last", "of_hits", "real_times", "recorded"]

Array = npt.NDArray[np.floating[Any]]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_SINGLE = {np.dtype(np.float64): np.float32, np.dtype(np.complex128): np.complex64}
_TURN = ((1, 2), (2, 0), (0, 1))  # axes of a cross product's parts


def as_single(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Floating-point values in single precision."""
    return values.astype(_SINGLE[values.dtype])


def real_times(real: Array, z: ComplexArray) -> ComplexArray:
    """Real (..., k, n) by complex (..., n, L), its lines contiguous: (..., k, L)."""
    return np.asarray(np.matmul(real, z.view(z.real.dtype)).view(z.dtype))


def lines_last(rows: ComplexArray, m: int) -> ComplexArray:
    """(P, L, m * 3, n) to (P, m, n, 3, L), contiguous."""
    P, L, _, n = rows.shape
    return np.ascontiguousarray(rows.reshape(P, L, m, 3, n).transpose(0, 2, 4, 3, 1))


def of_hits(by_hit: npt.NDArray[Any], hit: npt.NDArray[np.int64]) -> npt.NDArray[Any]:
    """(P, n_hits, ...) to (P, m, ...): each mounting's own hit."""
    if by_hit.shape[1] == 1:
        return np.broadcast_to(by_hit, (*hit.shape, *by_hit.shape[2:]))
    return np.asarray(by_hit[np.arange(len(hit))[:, None], hit])


def recorded(seen: Array, tilted: Array, s: ComplexArray, x: ComplexArray) -> ComplexArray:
    """Acceleration s^2 seen x and gravity's part tilted x (P, m, 3, L) of motions (P, m, n, L)."""
    return np.asarray((s**2)[:, None, None] * real_times(seen, x) + real_times(tilted, x))


def inverses_of_three(M: ComplexArray) -> ComplexArray:
    """Inverses of matrices (..., 3, 3, L), by cross products of their rows."""
    a, b, c = (M[..., i, :, :] for i in range(3))
    columns = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=-2)
    return np.asarray(columns / np.sum(a * columns[..., 0, :], axis=-2)[..., None, None, :])


def _cross(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """(..., 3, L)."""
    return np.stack(
        [a[..., i, :] * b[..., j, :] - a[..., j, :] * b[..., i, :] for i, j in _TURN], axis=-2
    )
