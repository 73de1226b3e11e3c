"""Misfit of many measurements at once, with its gradient and curvature by every parameter.

Mounting errors are taken off as `weigh` has it: what they take off a product is a sum of squares,
of each channel's own and of what the three of a mounting share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.columns import Columns
from armodal.analyzer.gap.model.weigh import Quadratic, Weighing, error_rows, stacked

__all__ = ["costs_of", "sloped", "summed"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_TELLING = 1.0 / np.finfo(np.float64).eps  # beyond it mounting errors take off more than is known


def summed(
    weighings: Sequence[Weighing], y: ComplexArray, columns: Columns, at: Sequence[int]
) -> tuple[Quadratic, list[float]]:
    """Misfit of lines alike, all at once.

    Parameters
    ----------
    weighings, at
        Of each measurement, and which of the predictions is of it: soft and hard hits share one.
    y, columns
        P predictions (P, m, 3, L) and their derivatives.

    Returns
    -------
    The sum over the measurements, and the cost of each.
    """
    left = _left(weighings, y, at, columns, y)
    gradient, curvature = _products(columns, left)
    whole = Quadratic(
        cost=float(left.costs.sum()), gradient=gradient, curvature=(curvature + curvature.T) / 2
    )
    return whole, left.costs.tolist()


def sloped(
    weighings: Sequence[Weighing],
    y: ComplexArray,
    about: tuple[ComplexArray, Columns],
    at: Sequence[int],
) -> tuple[float, Array]:
    """Misfit of predictions and its slope (n,) along columns of others, in single precision.

    Parameters
    ----------
    about
        Predictions (P, m, 3, L) near by and their derivatives, as of `summed`. Mounting errors are
        those there, so that slope and their curvature belong together.
    """
    beside, columns = about
    left = _left(weighings, y, at, columns, beside)
    along = np.zeros((*y.shape[:3], 2 * y.shape[3]))
    for slopes, errors in ((left.slopes, left.errors), (left.shared_slopes, left.shared_errors)):
        along += np.matmul(slopes[:, None], errors)[:, 0].reshape(along.shape)
    along -= left.pull.reshape(along.shape)
    along = (along * np.repeat(left.root, 2, axis=-1)).astype(columns.shared.real.dtype)
    gradient = np.zeros(columns.n)
    shared, own = (stacked(of) for of in (columns.shared, columns.own))
    gradient[columns.rows] = shared.reshape(len(shared), -1) @ along.reshape(-1)
    np.add.at(gradient, columns.own_rows, np.einsum("jpmcl,pmcl->jpm", own, along))
    return float(left.costs.sum()), gradient


@dataclass(frozen=True, slots=True)
class _Left:
    """What predictions leave of measurements, and what mounting errors make of it."""

    root: Array  # (P, m, 3, L) of the weights
    pull: Array  # (P m 3 2L,) the residual
    errors: Array  # (P m 3, t 3, 2L) rows of each channel's own errors, t turns of measurements
    slopes: Array  # (P m 3, t 3) their products with the residual
    shared_errors: Array  # (P m, t k, 3 2L) of what the channels of a mounting share
    shared_slopes: Array  # (P m, t k)
    costs: Array  # (measurements,)


def _left(
    weighings: Sequence[Weighing],
    y: ComplexArray,
    at: Sequence[int],
    columns: Columns,
    errors_of: ComplexArray,
) -> _Left:
    """`errors_of` (P, m, 3, L) are the predictions that mounting errors are products of."""
    P, m, _, L = y.shape
    # A prediction's derivatives have the root of all its weights, of which each measurement has a
    # part: one product serves soft and hard hits.
    square = np.zeros((P, m, 3, L))
    for weighing, p in zip(weighings, at, strict=True):
        square[p] += weighing.scale**2
    root = np.sqrt(square)
    pull = np.zeros((P, m, 3, 2 * L))
    costs = np.zeros(len(at))
    turns = _turns(at)
    t, k = len(turns), weighings[0].places.shape[2]
    kind = columns.shared.real.dtype
    errors = np.zeros((P, m, 3, t, 3, 2 * L), kind)
    slopes = np.zeros((P, m, 3, t, 3))
    shared_errors = np.zeros((P, m, t, k, 3, 2 * L), kind)
    shared_slopes = np.zeros((P, m, t, k))
    for number, turn in enumerate(turns):
        rows = [at[k] for k in turn]
        found = _measured([weighings[k] for k in turn], y[rows], errors_of[rows])
        costs[turn] = found.costs
        part = np.repeat(found.scale / root[rows].reshape(-1, 3, L), 2, axis=-1)
        shape = (len(rows), m)
        errors[rows, :, :, number] = (part[:, :, None] * found.own).reshape(*shape, 3, 3, 2 * L)
        slopes[rows, :, :, number] = found.own_slopes.reshape(*shape, 3, 3)
        shared = part[:, None] * found.shared
        shared_errors[rows, :, number] = shared.reshape(*shape, k, 3, 2 * L)
        shared_slopes[rows, :, number] = found.shared_slopes.reshape(*shape, k)
        pull[rows] += (part * found.residual).reshape(*shape, 3, 2 * L)
    return _Left(
        root=root,
        pull=pull.reshape(-1),
        errors=errors.reshape(P * m * 3, -1, 2 * L),
        slopes=slopes.reshape(P * m * 3, -1),
        shared_errors=shared_errors.reshape(P * m, t * k, 6 * L),
        shared_slopes=shared_slopes.reshape(P * m, t * k),
        costs=costs,
    )


def _products(columns: Columns, left: _Left) -> tuple[Array, Array]:
    """Gradient (n,) and curvature (n, n) of weighted derivatives, mounting errors taken off.

    In double precision: steps are made of the smallest eigenvalues.
    """
    errors, shared_errors = left.errors, left.shared_errors
    M = len(shared_errors)  # mountings, of all predictions
    weights = np.repeat(left.root, 2, axis=-1)
    flat_weights = weights.reshape(-1)

    def weighed(rows: Array) -> Array:
        """(g, 2L, k) what is multiplied with derivatives that are not weighted yet."""
        own = rows * weights.reshape(len(rows), 1, -1)
        return np.asarray(own.astype(rows.dtype).swapaxes(-1, -2))

    weighed_errors = weighed(errors), weighed(shared_errors)
    slopes = np.concatenate([left.slopes.reshape(M, -1), left.shared_slopes], axis=1)

    def products(dy: ComplexArray) -> tuple[Array, Array]:
        """(j, M 6L) derivatives and (j, M k) their products with each mounting's errors."""
        J = stacked(dy).reshape(len(dy), -1)
        found = []
        for rows in weighed_errors:
            by_group = J.reshape(len(dy), len(rows), -1).swapaxes(0, 1)
            of_rows = np.matmul(by_group, rows).swapaxes(0, 1)  # (j, g, k)
            k = rows.shape[-1] * len(rows) // M
            found.append(of_rows.reshape(len(dy), M, k).astype(np.float64))
        return J * flat_weights, np.concatenate(found, axis=-1).reshape(len(dy), -1)

    gradient, curvature = np.zeros(columns.n), np.zeros((columns.n, columns.n))
    J, E = products(columns.shared)
    curvature[np.ix_(columns.rows, columns.rows)] = J @ J.T - E @ E.T
    gradient[columns.rows] = E @ slopes.reshape(-1) - J @ left.pull
    j = len(columns.own_rows)
    if j:
        each = (*products(columns.own), J, E)
        J_own, E_own, J, E = (of.reshape(len(of), M, -1).swapaxes(0, 1) for of in each)
        across = J_own @ J.swapaxes(1, 2) - E_own @ E.swapaxes(1, 2)  # (M, j, k)
        alone = J_own @ J_own.swapaxes(1, 2) - E_own @ E_own.swapaxes(1, 2)
        slope = E_own @ slopes[..., None] - J_own @ left.pull.reshape(M, -1, 1)
        at = columns.own_rows.reshape(j, -1).T  # (M, j)
        each_once, of_each = np.unique(at, return_inverse=True)
        is_of = of_each.reshape(-1) == np.arange(len(each_once))[:, None]
        beside = is_of.astype(np.float64) @ across.reshape(at.size, -1)  # sums over mountings
        curvature[np.ix_(each_once, columns.rows)] += beside
        curvature[np.ix_(columns.rows, each_once)] += beside.T
        np.add.at(curvature, (at[:, :, None], at[:, None]), alone)
        np.add.at(gradient, at, slope[..., 0])
    return gradient, curvature


def costs_of(weighings: Sequence[Weighing], y: ComplexArray) -> list[float]:
    """chi^2 / 2 of lines alike, all at once: each measurement's prediction, y (P, m, 3, L)."""
    return [float(cost) for cost in _measured(weighings, y, y).costs]


@dataclass(frozen=True, slots=True)
class _Measured:
    """Measurements of lines alike beside their predictions, M mountings of all together."""

    scale: Array  # (M, 3, L)
    residual: Array  # (M, 3, 2L)
    own: Array  # (M, 3, 3, 2L) rows of each channel's own errors
    own_slopes: Array  # (M, 3, 3) their products with the residual
    shared: Array  # (M, k, 3, 2L) of what the three channels share
    shared_slopes: Array  # (M, k)
    costs: Array  # (P,) chi^2 / 2


def _measured(weighings: Sequence[Weighing], y: ComplexArray, errors_of: ComplexArray) -> _Measured:
    """Set measurements beside predictions (P, m, 3, L); `errors_of`: as of `_left`.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a prediction is so far off that rounding moves its cost by nats.
    """
    there = y.reshape(-1, *y.shape[2:])
    values, scale, prior, places = (
        np.concatenate(of)
        for of in zip(
            *((w.lines.values, w.scale, w.prior, w.places) for w in weighings), strict=True
        )
    )
    r = stacked((values - there) * scale)
    own, shared = error_rows(scale, prior, places, errors_of.reshape(there.shape))
    own_slopes = np.matmul(own, r[..., None])[..., 0]
    flat = shared.reshape(*shared.shape[:2], r[0].size)
    shared_slopes = np.matmul(flat, r.reshape(len(r), -1, 1))[..., 0]
    squares = np.sum(r * r, axis=(1, 2))
    if not np.all(squares < _TELLING):
        raise np.linalg.LinAlgError("Predictions so far off that rounding alone is nats")
    by_mounting = squares - np.sum(own_slopes**2, axis=(1, 2)) - np.sum(shared_slopes**2, axis=1)
    return _Measured(
        scale=scale,
        residual=r,
        own=own,
        own_slopes=own_slopes,
        shared=shared,
        shared_slopes=shared_slopes,
        costs=0.5 * by_mounting.reshape(len(y), -1).sum(axis=1),
    )


def _turns(at: Sequence[int]) -> list[list[int]]:
    """Measurements in turns, each prediction once a turn."""
    turns: list[list[int]] = []
    seen: dict[int, int] = {}
    for k, p in enumerate(at):
        turn = seen[p] = seen.get(p, -1) + 1
        if turn == len(turns):
            turns.append([])
        turns[turn].append(k)
    return turns
