"""Signals that accelerances of known poles are made of, linear in real coefficients."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

__all__ = ["modal_basis", "real_lines"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


def real_lines(x: ComplexArray) -> Array:
    """Real parts of all lines, then imaginary parts, along the last axis."""
    result: Array = np.concatenate([x.real, x.imag], axis=-1)
    return result


def modal_basis(s: ComplexArray, poles: Sequence[complex]) -> ComplexArray:
    """Signals (2 n_modes + 3, n_lines): two a mode, then 1, s, s^2 for modes outside the band.

    A mode with residue R = u + j v is s^2 (R / (s - pole) + conj(R) / (s - conj(pole))), u times
    the first of its signals plus v times the second.
    """
    rows = []
    for pole in poles:
        a, b = s**2 / (s - pole), s**2 / (s - np.conj(pole))
        rows += [(a + b) / abs(pole), 1j * (a - b) / abs(pole)]
    scale = np.abs(s).max()
    rows += [np.ones_like(s), s / scale, (s / scale) ** 2]
    return np.stack(rows)
