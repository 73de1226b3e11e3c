"""Stability lobes of milling by the mean of the cutting forces (zero-order solution).

Altintas and Budak, CIRP Annals 44 (1995) 357: at the limit of stability the tool swings at omega
with det(I + Lambda Phi) = 0, Phi = alpha G(j omega), and

    Lambda = -N / (4 pi) a K_t (1 - e^(-j omega T)) .

With kappa = Im / Re of Lambda: a = -2 pi Re Lambda (1 + kappa^2) / (N K_t), and the phase of the
wave left from one tooth to the next is pi - 2 atan kappa. Both directions of the tool couple
through the whole 2 x 2 FRF, so that mode coupling is in it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.acting.cutting import Cutter, oriented

__all__ = ["limit_of_depth", "lobes"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_NONE = 1e-12


def lobes(cutter: Cutter, frf: ComplexArray, f_hz: Array, speeds_rpm: Array) -> Array:
    """Return the deepest stable cut in m at each speed; inf where none of the lines limits it.

    Parameters
    ----------
    frf
        (n_lines, 2, 2) receptance of the tool over the work, feed and normal, m/N.
    f_hz
        (n_lines,), even or not, over all modes that may chatter.
    speeds_rpm
        (n_speeds,).
    """
    depth, phase = _limits(cutter, frf)
    turns = f_hz * 60.0 / (cutter.teeth * speeds_rpm[:, None])  # (n_speeds, n_lines) waves, whole
    found = np.full(len(speeds_rpm), np.inf)
    for root in range(2):
        # Waves between teeth less the phase left: a whole number at the limit.
        waves = turns - phase[root] / (2.0 * np.pi)
        with np.errstate(invalid="ignore"):
            whole = np.floor(waves)
            step = waves[:, 1:] - waves[:, :-1]
            crossed = np.maximum(whole[:, 1:], whole[:, :-1])
            # A jump of the phase by a whole turn is no crossing.
            crosses = (whole[:, 1:] != whole[:, :-1]) & (np.abs(step) < 0.5)
            part = np.where(crosses, (crossed - waves[:, :-1]) / np.where(crosses, step, 1.0), 0.0)
            own = depth[root, :-1] + part * (depth[root, 1:] - depth[root, :-1])
            good = crosses & np.isfinite(own) & (own > 0.0)
        found = np.minimum(found, np.where(good, own, np.inf).min(axis=1))
    return found


def limit_of_depth(cutter: Cutter, frf: ComplexArray) -> float:
    """Return the cut in m that is stable at every speed; inf if every one is."""
    depth, _ = _limits(cutter, frf)
    good = depth[np.isfinite(depth) & (depth > 0.0)]
    return float(good.min()) if good.size else float(np.inf)


def _limits(cutter: Cutter, frf: ComplexArray) -> tuple[Array, Array]:
    """(2, n_lines) depths at the limit, negative or inf where there is none; phases in rad."""
    Phi = oriented(cutter) @ frf
    a0 = Phi[:, 0, 0] * Phi[:, 1, 1] - Phi[:, 0, 1] * Phi[:, 1, 0]
    a1 = Phi[:, 0, 0] + Phi[:, 1, 1]
    # 1 / Lambda are minus the eigenvalues of Phi: no division where its determinant is zero.
    root = np.sqrt(a1**2 - 4.0 * a0)
    values = np.stack([-(a1 + root) / 2.0, -(a1 - root) / 2.0])
    values = _followed(values)
    size = np.abs(values)
    there = size > _NONE * size.max(initial=0.0)
    Lambda = np.where(there, 1.0 / np.where(there, values, 1.0), np.inf)
    with np.errstate(invalid="ignore", divide="ignore"):
        kappa = Lambda.imag / Lambda.real
        depth = (
            -2.0
            * np.pi
            * Lambda.real
            * (1.0 + kappa**2)
            / (cutter.teeth * cutter.tangential_n_per_m2)
        )
    phase = np.mod(np.pi - 2.0 * np.arctan(kappa), 2.0 * np.pi)
    return np.where(there, depth, np.inf), np.where(there, phase, np.nan)


def _followed(values: ComplexArray) -> ComplexArray:
    """Two roots so ordered that each goes on from line to line."""
    straight = np.abs(np.diff(values, axis=1)).sum(axis=0)
    swapped = np.abs(values[::-1, 1:] - values[:, :-1]).sum(axis=0)
    odd = np.concatenate([[False], np.cumsum(swapped < straight) % 2 == 1])
    return np.where(odd, values[::-1], values)
