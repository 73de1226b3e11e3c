"""Fit of the arm model to all FRFs of all postures: weighted, damped Gauss-Newton.

Weights are the measured variance plus an allowance for what no single hit repeats: a
mounting's tilt and the hit's aim bend one axis into another by about a per cent of the motion at
the point. The covariance does not trust these weights: see `scatter`.

References
----------
K. Levenberg, Q. Appl. Math. 2 (1944) 164.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.frf_model import PostureData, predict, predict_with_derivatives
from armodal.analyzer.identification.parameters import (
    FitState,
    ParameterNames,
    parameter_vector,
    step_state,
)
from armodal.analyzer.identification.scatter import ParameterScatter
from armodal.protocols.errors import EstimateError

__all__ = ["FrfFit", "fit_frfs", "line_weights", "normal_equations"]

Array = npt.NDArray[np.float64]

MOUNTING_ALLOWANCE = 0.01  # of the motion at a point: 0.5 degrees of tilt or aim


@dataclass(frozen=True, slots=True, kw_only=True)
class FrfFit:
    """A converged fit of the model to FRFs."""

    state: FitState
    parameters: ParameterNames
    scatter: ParameterScatter  # of the parameters, from measurement scatter and priors
    cost: float  # half the weighted sum of squares, priors included
    relative_residual: Array  # (n_postures,) rms residual over rms FRF, measured noise taken off
    iterations: int


def line_weights(data: PostureData) -> Array:
    """Return 1/variance of every FRF value, (n_mountings, n_refs, 3, n_lines)."""
    motion = (np.abs(data.values) ** 2).sum(axis=2, keepdims=True)
    variance = data.variance + MOUNTING_ALLOWANCE**2 * motion
    # A point that does not move (the base) still has its noise; nothing has none at all.
    floor = 1e-12 * float(motion.max())
    return np.asarray(1.0 / np.maximum(variance, floor))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Normal:
    H: Array  # (n, n) without priors
    gradient: Array  # (n,)
    cost: float
    cluster_hessian: Array  # (n_clusters, n, n)
    cluster_g: Array  # (n_clusters, n)
    relative_residual: Array  # (n_postures,)


def normal_equations(
    superset: Superset,
    postures: tuple[PostureData, ...],
    weights: tuple[Array, ...],
    state: FitState,
) -> _Normal:
    """Accumulate Jᵀ W J and Jᵀ W r by cluster over all postures at a state."""
    blocks, scores, cost, relative = [], [], 0.0, []
    for i, (data, weight) in enumerate(zip(postures, weights, strict=True)):
        y, dy = predict_with_derivatives(superset, data, state, i)
        rest = data.values - y
        root = np.sqrt(weight)
        n_clusters = y.shape[0] * y.shape[1]
        J = np.moveaxis((dy * root).reshape(len(dy), n_clusters, -1), 0, 2)
        r = (rest * root).reshape(n_clusters, -1)
        J = np.concatenate([J.real, J.imag], axis=1)
        r = np.concatenate([r.real, r.imag], axis=1)
        blocks.append(np.matmul(J.transpose(0, 2, 1), J))
        scores.append(np.matmul(J.transpose(0, 2, 1), r[..., None])[..., 0])
        cost += 0.5 * float((r**2).sum())
        relative.append(_unexplained(data, rest))
    cluster_hessian, cluster_g = np.concatenate(blocks), np.concatenate(scores)
    return _Normal(
        H=cluster_hessian.sum(axis=0),
        gradient=cluster_g.sum(axis=0),
        cost=cost,
        cluster_hessian=cluster_hessian,
        cluster_g=cluster_g,
        relative_residual=np.array(relative),
    )


def _unexplained(data: PostureData, rest: npt.NDArray[np.complex128]) -> float:
    """Part of the rms motion that neither model nor measured noise explains."""
    noise = float(data.variance.sum())
    left = float((np.abs(rest) ** 2).sum()) - noise
    motion = float((np.abs(data.values) ** 2).sum()) - noise
    return float(np.sqrt(max(left, 0.0) / motion)) if motion > 0.0 else np.inf


def _cost(
    superset: Superset,
    postures: tuple[PostureData, ...],
    weights: tuple[Array, ...],
    state: FitState,
    precision: Array,
) -> float:
    total = 0.5 * float(precision @ parameter_vector(state) ** 2)
    for i, (data, weight) in enumerate(zip(postures, weights, strict=True)):
        y = predict(superset, data, state, i)
        total += 0.5 * float((weight * np.abs(data.values - y) ** 2).sum())
    return total


def fit_frfs(
    superset: Superset,
    postures: tuple[PostureData, ...],
    start: FitState,
    *,
    max_iterations: int = 60,
    beaten: float = np.inf,
) -> FrfFit:
    """Fit the model's parameters to the FRFs of several postures.

    Parameters
    ----------
    beaten
        Cost of another fit. This one is given up, and returned as it is, once it would stay above
        if every iteration left gained twice what the quadratic model promises of the last.

    Raises
    ------
    EstimateError
        If the iteration does not converge; the last fit is in `partial`.
    """
    names = ParameterNames.of(superset.arm, start.structure, tuple(data.name for data in postures))
    precision = 1.0 / names.prior_std**2
    weights = tuple(line_weights(data) for data in postures)
    state, damping, converged = start, 1e-3, False
    normal = normal_equations(superset, postures, weights, state)
    cost = normal.cost + 0.5 * float(precision @ parameter_vector(state) ** 2)
    iteration = 0
    while not converged and iteration < max_iterations:
        iteration += 1
        H = normal.H + np.diag(precision)
        gradient = normal.gradient - precision * parameter_vector(state)
        if np.isfinite(beaten):
            promised = float(gradient @ np.linalg.lstsq(H, gradient)[0])
            if cost - (max_iterations - iteration) * promised > beaten:
                break
        step = np.linalg.solve(H + damping * np.diag(np.diag(H)), gradient)
        largest = float(np.abs(step).max())
        step *= min(1.0, 1.0 / largest) if largest > 0.0 else 1.0  # no log or angle beyond 1
        trial = step_state(state, np.asarray(step, dtype=np.float64))
        trial_cost = _cost(superset, postures, weights, trial, precision)
        if np.isfinite(trial_cost) and trial_cost < cost:
            # Converged: the decrease still promised is far below the scatter of chi squared.
            converged = cost - trial_cost < 1e-9 * cost + 1e-6 and damping <= 1e-3
            state, cost, damping = trial, trial_cost, max(damping / 10, 1e-9)
            normal = normal_equations(superset, postures, weights, state)
        else:
            # What the undamped step promises is nothing beside the scatter of chi squared.
            promised = float(gradient @ np.linalg.solve(H, gradient))
            converged = promised < 1e-7 * cost + 1e-6
            damping *= 10
            if damping > 1e12:
                break
    fit = _finish(names, normal, state, cost, iteration)
    if not converged and cost <= beaten:
        raise EstimateError(
            f"the model fit did not converge in {iteration} iterations "
            f"(relative residual {fit.relative_residual.round(3).tolist()}); "
            "the model may lack an effect, or the starting stiffness is too far off",
            partial=fit,
        )
    return fit


def _finish(
    names: ParameterNames,
    normal: _Normal,
    state: FitState,
    cost: float,
    iterations: int,
) -> FrfFit:
    return FrfFit(
        state=state,
        parameters=names,
        scatter=ParameterScatter.of(normal.cluster_hessian, normal.cluster_g, names.prior_std),
        cost=cost,
        relative_residual=normal.relative_residual,
        iterations=iterations,
    )
