"""Maximum-likelihood refinement of the poles, residues eliminated.

Variable projection (Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413) with Kaufman's
simplified Jacobian, in Gram matrices; Levenberg's damping makes every accepted step downhill.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.regression import ModalData, Regression, regress

__all__ = ["MOST_STEPS", "TOLERANCE", "admissible", "admissible_each", "refine_poles"]

_MOST_DAMPING = 0.6
MOST_STEPS = 12  # accepted or not
TOLERANCE = 1e-5  # of its half bandwidth, that a pole still moves by at the end
_LEAST_GAIN = 1e-3  # of a line's misfit: a step of all poles by a thirtieth of their scatter


def admissible(poles: npt.NDArray[np.complex128]) -> bool:
    """Whether all poles decay, oscillate, and are damped less than a structure can be."""
    return bool(admissible_each(poles[None])[0])


def admissible_each(poles: npt.NDArray[np.complex128]) -> npt.NDArray[np.bool_]:
    """Whether all poles of each row are `admissible`: (n, n_modes) to (n,)."""
    fit: npt.NDArray[np.bool_] = (
        (poles.real < 0.0) & (poles.imag > 0.0) & (-poles.real < _MOST_DAMPING * np.abs(poles))
    )
    result: npt.NDArray[np.bool_] = np.all(fit, axis=1)
    return result


def refine_poles(
    data: ModalData,
    start: npt.NDArray[np.complex128],
    *,
    enough: Callable[[float, float], bool] | None = None,
    held: npt.NDArray[np.bool_] | None = None,
) -> Regression:
    """Move the poles to the least weighted sum of squares.

    Parameters
    ----------
    data
        FRFs weighted by one over their variance.
    start
        (n_modes,) poles in rad/s.
    enough
        Told the cost before and after each step taken; True stops there.
    held
        (n_modes,) poles that stay where they are; none by default.

    Returns
    -------
    Regression
        At the best poles found, with information and score there.
    """
    current = regress(data, start)
    if start.size == 0:
        return current
    damping = 1e-6
    total = float(current.cost.sum())
    for _ in range(MOST_STEPS):
        A = current.information.sum(axis=0)
        g = current.score.sum(axis=0)
        # A pole that nothing tells of stays where it is.
        told = np.diag(A) > np.finfo(float).tiny
        if held is not None:
            told &= ~np.repeat(held, 2)
        scale = np.where(told, 1.0 / np.sqrt(np.where(told, np.diag(A), 1.0)), 0.0)
        normal = A * scale[:, None] * scale[None, :] + damping * np.eye(g.size)
        step = np.linalg.solve(normal, g * scale) * scale
        moved = current.poles + step[0::2] + 1j * step[1::2]
        if admissible(moved):
            trial = regress(data, moved)
            reached = float(trial.cost.sum())
        else:
            reached = np.inf
        share = np.max(np.abs(moved - current.poles) / np.abs(current.poles.real))
        if reached <= total * (1.0 + 1e-12):
            before, current, total = total, trial, reached
            damping = max(damping / 10.0, 1e-9)
            done = share < TOLERANCE or (before - total) * data.values.size <= _LEAST_GAIN * total
            if done or (enough is not None and enough(before, total)):
                break
        else:
            if share < TOLERANCE:
                break
            damping = min(max(damping * 30.0, 1e-3), 1e6)
    return current
