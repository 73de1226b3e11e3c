"""Matrices of the equations on every line, and their inverses."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from armodal.analyzer.arm.hysteresis import hysteresis, lost_by_power, relaxed
from armodal.analyzer.gap.model.system import System

__all__ = ["dynamic_stiffness", "inverses", "resists"]

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_BLOCK = 64  # columns that LAPACK works on at a time


def dynamic_stiffness(
    system: System, s: ComplexArray, rows: Indices | None = None, columns: Indices | None = None
) -> ComplexArray:
    """Return (P, L, n, n) s^2 M + s C + K + h(s) D + z(s) R, or some rows and columns of it.

    Few coordinates have a damper or a loss.
    """
    at = [slice(None) if of is None else of for of in (rows, columns)]

    def part(matrix: Array) -> Array:
        return matrix[:, at[0]][..., at[1]]

    Z = (s**2)[..., None, None] * part(system.mass)[:, None]
    Z += part(system.stiffness)[:, None]
    lost = lost_by_power(s, system.loss_power)
    weighed = [(s, part(system.damping)), (lost, part(system.loss))]
    for r, rate in enumerate(system.relaxing_rad_s.T):
        weighed.append((relaxed(s, rate), part(system.relaxing[:, r])))
    for weight, matrix in weighed:
        i, j = np.nonzero(matrix.any(axis=0))
        Z[..., i, j] += weight[..., None] * matrix[:, None, i, j]
    return np.asarray(Z)


def resists(system: System, s: ComplexArray) -> ComplexArray:
    """Return (P, L, n) by how much a compliance resists more than without its losses, at s (P, L).

    1 + tau s + eta L(s): a loss that grows with frequency and one that does not.
    """
    more = s[..., None] * system.compliance_loss_s[:, None]
    at = np.flatnonzero(system.compliance_loss_factor.any(axis=0))
    more[..., at] += hysteresis(s)[..., None] * system.compliance_loss_factor[:, None, at]
    return np.asarray(1.0 + more)


def inverses(A: ComplexArray) -> ComplexArray:
    """Return the inverses of matrices (..., n, n).

    By their factors, which is three quarters of the work of solving for the identity.

    Raises
    ------
    numpy.linalg.LinAlgError
        If one is singular.
    """
    found = np.empty_like(A)
    n = A.shape[-1]
    for one, inverse in zip(A.reshape(-1, n, n), found.reshape(-1, n, n), strict=True):
        factors, pivots, failed = lapack.zgetrf(one.T)
        if failed == 0:
            inverse.T[:], failed = lapack.zgetri(
                factors, pivots, lwork=_BLOCK * n, overwrite_lu=True
            )
        if failed != 0:
            raise np.linalg.LinAlgError("Singular matrix")
    return found
