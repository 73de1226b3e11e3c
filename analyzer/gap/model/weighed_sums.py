"""Misfit of many measurements at once, with its gradient and curvature by every parameter.

Mounting errors are taken off as `weigh` has it: of a matrix R with R'R = (N'N + I)^-1 each product
is one of r and RN'r, so what errors take off is a sum of squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.columns import Columns
from armodal.analyzer.gap.model.weigh import Quadratic, Weighing, nuisance, stacked

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
    gradient, curvature = _products(columns, left.root, left.slopes, left.pull, left.errors)
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
    along = np.matmul(left.slopes.reshape(len(left.errors), 1, -1), left.errors)[:, 0]
    along = (along - left.pull.reshape(along.shape)).reshape(*y.shape[:3], -1)
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
    slopes: Array  # (P m 3 t k,) products of mounting errors with the residual
    pull: Array  # (P m 3 2L,) the residual
    errors: Array  # (P m 3, t k, 2L) normed columns of the mountings' errors
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
    k = 3 + weighings[0].places.shape[2]
    errors = np.zeros((P, m, 3, len(turns), k, 2 * L), columns.shared.real.dtype)
    slopes = np.zeros((P, m, 3, len(turns), k))
    for number, turn in enumerate(turns):
        rows = [at[k] for k in turn]
        own = [weighings[k] for k in turn]
        scale, r, N, Nr, costs[turn] = _measured(own, y[rows], errors_of[rows])
        part = np.repeat(scale / root[rows].reshape(-1, 3, L), 2, axis=-1)
        errors[rows, :, :, number] = (part[:, :, None] * N).reshape(-1, m, 3, k, 2 * L)
        slopes[rows, :, :, number] = Nr.reshape(-1, m, 3, k)
        pull[rows] += (part * r).reshape(-1, m, 3, 2 * L)
    return _Left(
        root, slopes.reshape(-1), pull.reshape(-1), errors.reshape(P * m * 3, -1, 2 * L), costs
    )


def _products(
    columns: Columns, root: Array, slopes: Array, pull: Array, errors: Array
) -> tuple[Array, Array]:
    """Gradient (n,) and curvature (n, n) of weighted derivatives, mounting errors taken off.

    In double precision: steps are made of the smallest eigenvalues.

    Parameters
    ----------
    root
        (P, m, 3, L) of the weights.
    slopes, pull
        Products of mounting errors with the residual, and that itself, flat.
    errors
        (P m 3, k, 2L) normed columns of the mountings' errors.
    """
    weights = np.repeat(root, 2, axis=-1).reshape(len(errors), 1, -1)
    weighed_errors = (errors * weights).astype(errors.dtype).swapaxes(-1, -2)
    flat_weights = weights.reshape(-1)

    def weighed(dy: ComplexArray) -> tuple[Array, Array]:
        """(j, P m 3 2L) derivatives and (j, P m 3 k) their products with the mounting errors."""
        J = stacked(dy).reshape(len(dy), *errors.shape[::2])
        by_errors = np.matmul(J.swapaxes(0, 1), weighed_errors).swapaxes(0, 1)
        flat_errors = by_errors.reshape(len(dy), -1).astype(np.float64)
        return J.reshape(len(dy), -1) * flat_weights, flat_errors

    gradient, curvature = np.zeros(columns.n), np.zeros((columns.n, columns.n))
    J, E = weighed(columns.shared)
    curvature[np.ix_(columns.rows, columns.rows)] = J @ J.T - E @ E.T
    gradient[columns.rows] = E @ slopes - J @ pull
    j, P, m = columns.own_rows.shape
    if j:
        each = (*weighed(columns.own), J, E)
        J_own, E_own, J, E = (of.reshape(len(of), P * m, -1).swapaxes(0, 1) for of in each)
        across = J_own @ J.swapaxes(1, 2) - E_own @ E.swapaxes(1, 2)  # (P m, j, k)
        alone = J_own @ J_own.swapaxes(1, 2) - E_own @ E_own.swapaxes(1, 2)
        slope = E_own @ slopes.reshape(P * m, -1, 1) - J_own @ pull.reshape(P * m, -1, 1)
        at = columns.own_rows.reshape(j, -1).T  # (P m, j)
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
    *_, costs = _measured(weighings, y, y)
    return [float(cost) for cost in costs]


def _measured(
    weighings: Sequence[Weighing], y: ComplexArray, errors_of: ComplexArray
) -> tuple[Array, Array, Array, Array, Array]:
    """Measurements of lines alike beside their predictions (P, m, 3, L).

    `errors_of`: as of `_left`.

    Returns
    -------
    scale : (P m, 3, L)
    r : (P m, 3, 2L) residual
    N : (P m, 3, k, 2L) (N'N + I)^-1/2 N': what errors take off is then a sum of squares
    Nr : (P m, 3, k) their product with the residual
    costs : (P,) chi^2 / 2

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
    beside = errors_of.reshape(there.shape)
    N = nuisance(scale, prior, places, beside).swapaxes(-1, -2)
    N = np.matmul(_root_of_inverse(N), N)
    Nr = np.matmul(N, r[..., None])[..., 0]
    squares = np.sum(r * r, axis=-1)
    if not np.all(squares < _TELLING):
        raise np.linalg.LinAlgError("Predictions so far off that rounding alone is nats")
    by_channel = squares - np.sum(Nr * Nr, axis=-1)
    return scale, r, N, Nr, 0.5 * by_channel.reshape(len(y), -1).sum(axis=1)


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


def _root_of_inverse(N: Array) -> Array:
    """(m, 3, k, k) matrices R with R'R = (N N' + I)^-1, of rows N (m, 3, k, 2L)."""
    gram = np.matmul(N, N.swapaxes(-1, -2)) + np.eye(N.shape[-2])  # never near singular
    return np.asarray(np.linalg.inv(np.linalg.cholesky(gram)))
