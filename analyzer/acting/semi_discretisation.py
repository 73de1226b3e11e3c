"""Stability of milling from the delayed equations themselves, their period cut into steps.

Insperger and Stepan, Int. J. Numer. Meth. Engng 61 (2004) 117: in each step the coefficients and
the delayed place are taken as even; what one period makes of the state is a matrix, and the cut is
stable if none of its eigenvalues is larger than one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.analyzer.acting.cutting import Cutter, tooth_stiffness

__all__ = ["ToolModes", "depth_limit", "spectral_radius"]

Array = npt.NDArray[np.float64]

_HALVINGS = 11  # of the depth looked for: a part in two thousand


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolModes:
    """m modes of the tool, of unit modal mass."""

    omega_rad_s: Array  # (m,)
    damping_ratio: Array  # (m,)
    shape: Array  # (2, m) in feed and normal


def spectral_radius(
    modes: ToolModes, cutter: Cutter, speed_rpm: float, depth_m: float, *, n_steps: int = 40
) -> float:
    """Return the largest eigenvalue of one tooth's period, in size; above one it chatters."""
    m = len(modes.omega_rad_s)
    period = 60.0 / (cutter.teeth * speed_rpm)
    h = period / n_steps
    H = depth_m * tooth_stiffness(cutter, n_steps)
    phi = modes.shape
    n = 2 * m + 2 * n_steps
    found = np.eye(n)
    for i in range(n_steps):
        A = np.zeros((2 * m, 2 * m))
        A[:m, m:] = np.eye(m)
        A[m:, :m] = -np.diag(modes.omega_rad_s**2) - phi.T @ H[i] @ phi
        A[m:, m:] = -np.diag(2.0 * modes.damping_ratio * modes.omega_rad_s)
        by_delayed = np.zeros((2 * m, 2))
        by_delayed[m:] = phi.T @ H[i]
        whole = np.zeros((2 * m + 2, 2 * m + 2))
        whole[: 2 * m, : 2 * m], whole[: 2 * m, 2 * m :] = A, by_delayed
        step = scipy.linalg.expm(h * whole)  # both the free motion and that by an even load
        P, R = step[: 2 * m, : 2 * m], step[: 2 * m, 2 * m :]
        delayed = 0.5 * (found[-2:] + found[-4:-2])
        now = found[: 2 * m]
        found = np.concatenate([P @ now + R @ delayed, phi @ now[:m], found[2 * m : -2]])
    return float(np.abs(np.linalg.eigvals(found)).max())


def depth_limit(
    modes: ToolModes, cutter: Cutter, speed_rpm: float, most_m: float, *, n_steps: int = 40
) -> float:
    """Return the deepest stable cut in m at a speed, below `most_m`, by halving."""
    low, high = 0.0, most_m
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if spectral_radius(modes, cutter, speed_rpm, middle, n_steps=n_steps) > 1.0:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
