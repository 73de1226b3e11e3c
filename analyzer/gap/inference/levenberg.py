"""One damped step of a fit, within its bounds, and how much the next is damped."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.box import least_in_box
from armodal.analyzer.gap.model.space import Space

__all__ = ["FIRST_DAMPING", "damped_step", "next_damping", "promise"]

Array = npt.NDArray[np.float64]

# Of the priors' curvature, which is one: with as much a step goes half its way where the data tell
# nothing, and all of it where they tell.
FIRST_DAMPING, _LEAST_DAMPING = 1.0, 1e-3
_FELT = 0.1  # damping after a step that failed: less hardly changes the next
_POOR, _GOOD = 0.25, 0.6  # of what a step promised: below and above, the damping changes


def damped_step(
    space: Space, u: Array, slope: Array, curvature: Array, damping: float
) -> tuple[Array, float]:
    """The step within the bounds that is best by the damped quadratic; what it promises undamped.

    Levenberg, Quart. Appl. Math. 2 (1944) 164, in prior deviations: the length of a step is
    measured by what one believed. Damped by its own curvature (Marquardt 1963) a parameter whose
    effect others take back would hardly move (`docs/decisions/0010-steps-within-bounds.md`).
    """
    A = curvature + np.eye(len(u))
    step = least_in_box(A + damping * np.eye(len(u)), slope, space.low - u, space.high - u)
    return step, promise(A, slope, step)


def promise(A: Array, slope: Array, step: Array) -> float:
    """By how much a step (n,) lowers the quadratic of curvature A (n, n) and slope (n,)."""
    return -float(slope @ step + 0.5 * step @ (A @ step))


def next_damping(damping: float, kept: float) -> float:
    """By how much of what a step promised it kept."""
    if not kept > 0.0:
        return max(10.0 * damping, _FELT)
    if kept < _POOR:
        return 4.0 * damping
    return max(damping / 10.0, _LEAST_DAMPING) if kept > _GOOD else damping
