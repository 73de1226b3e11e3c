"""Poles of many groups of FRFs refined at once, each group with poles of its own.

The steps are those of `refine`, group by group. Groups are small, a few FRFs on some tens of lines:
taken one after the other nearly all time would go into calls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.gram import WeightedLines, gram, weighted_lines
from armodal.analyzer.modal.refine import MOST_STEPS, TOLERANCE, admissible_each
from armodal.analyzer.modal.regression import (
    RIDGE,
    ModalData,
)

__all__ = ["refine_each"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]
_Int = npt.NDArray[np.int64]

_MOST_NUMBERS = 2**20  # of regressors times weights held at a time


@dataclass(frozen=True, slots=True, kw_only=True)
class _Groups:
    """FRFs by group, filled up to as many as the largest group has with such of no weight."""

    lines: WeightedLines  # (n_groups) of them, weights of the rows in them
    energy: _Real  # (n_groups, n_frf)
    filled: npt.NDArray[np.bool_]  # (n_groups, n_frf)

    def of(self, which: _Int) -> _Groups:
        """Some of the groups, one more than once if asked for."""
        return _Groups(
            lines=self.lines.of(which),
            energy=self.energy[which],
            filled=self.filled[which],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Fits:
    """Of every group: poles (n_groups, n), misfit, and what a step on the poles needs."""

    poles: _Complex
    cost: _Real  # (n_groups,)
    information: _Real  # (n_groups, 2 n, 2 n)
    score: _Real  # (n_groups, 2 n)


def refine_each(data: ModalData, group: _Int, starts: _Complex) -> tuple[_Complex, _Real]:
    """Move every group's poles to the least weighted sum of squares of its own FRFs.

    Parameters
    ----------
    data
        FRFs weighted by one over their variance, one row an FRF.
    group
        (n_frf,) group of each row, from 0; a row of -1 belongs to none.
    starts
        (n_starts, n_groups, n) poles in rad/s.

    Returns
    -------
    poles, cost
        The best found from each start, and what is left there: (n_starts, n_groups, n) and
        (n_starts, n_groups).
    """
    n_starts, n_groups, n = starts.shape
    groups = _by_group(data, group, n_groups)
    numbers = groups.lines.factors[0].size + 4 * n * data.s.size
    at_once = max(_MOST_NUMBERS // numbers, 1)
    flat = starts.reshape(-1, n)
    which = np.tile(np.arange(n_groups), n_starts)
    found = [
        _refined(groups.of(which[first : first + at_once]), flat[first : first + at_once])
        for first in range(0, flat.shape[0], at_once)
    ]
    poles = np.concatenate([one.poles for one in found]).reshape(starts.shape)
    return poles, np.concatenate([one.cost for one in found]).reshape(n_starts, n_groups)


def _by_group(data: ModalData, group: _Int, n_groups: int) -> _Groups:
    members = [np.flatnonzero(group == g) for g in range(n_groups)]
    most = max(own.size for own in members)
    at = np.zeros((n_groups, most), dtype=np.intp)
    filled = np.zeros((n_groups, most), dtype=bool)
    for g, own in enumerate(members):
        at[g, : own.size] = own
        filled[g, : own.size] = data.row_weight[own] > 0.0
    weight = np.broadcast_to(data.weight, data.values.shape)[at]
    weight = np.where(filled, data.row_weight[at], 0.0)[..., None] * weight
    values = data.values[at]
    return _Groups(
        lines=weighted_lines(data.s, weight, weight * values, data.terms),
        energy=np.sum(weight * np.abs(values) ** 2, axis=-1),
        filled=filled,
    )


def _refined(groups: _Groups, start: _Complex) -> _Fits:
    current = _fits(groups, start)
    damping = np.full(start.shape[0], 1e-6)
    going = np.arange(start.shape[0])
    for _ in range(MOST_STEPS):
        moved, step = _moved(current, going, damping[going])
        share = np.max(np.abs(step) / np.abs(current.poles[going].real), axis=1)
        allowed = admissible_each(moved)
        trial = _fits(groups.of(going[allowed]), moved[allowed])
        reached = np.full(going.size, np.inf)
        reached[allowed] = trial.cost
        better = reached <= current.cost[going] * (1.0 + 1e-12)
        for name in ("poles", "cost", "information", "score"):
            getattr(current, name)[going[better]] = getattr(trial, name)[better[allowed]]
        less, more = np.maximum(damping / 10.0, 1e-9), np.maximum(damping * 30.0, 1e-3)
        damping[going] = np.where(better, less[going], np.minimum(more[going], 1e6))
        going = going[share >= TOLERANCE]
        if not going.size:
            break
    return current


def _moved(fits: _Fits, which: _Int, damping: _Real) -> tuple[_Complex, _Complex]:
    """Poles after one damped step, and the step: (n, n_poles)."""
    A, g = fits.information[which], fits.score[which]
    diagonal = np.einsum("gii->gi", A)
    told = diagonal > np.finfo(float).tiny  # a pole that nothing tells of stays where it is
    scale = np.where(told, 1.0 / np.sqrt(np.where(told, diagonal, 1.0)), 0.0)
    normal = A * scale[:, :, None] * scale[:, None, :]
    normal += damping[:, None, None] * np.eye(g.shape[1])
    step = np.linalg.solve(normal, (g * scale)[..., None])[..., 0] * scale
    change = step[:, 0::2] + 1j * step[:, 1::2]
    return fits.poles[which] + change, change


def _fits(groups: _Groups, poles: _Complex) -> _Fits:
    """Least squares of every group for given poles; formulas and scaling of `regression`."""
    n = poles.shape[1]
    p = 2 * n + groups.lines.residual_gram.shape[-1]
    G, b = gram(groups.lines, poles)
    G[~groups.filled] = np.eye(G.shape[-1])
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("gfii->gfi", G[..., :p, :p]), np.finfo(float).tiny))
    G11 = G[..., :p, :p] * scale[..., :, None] * scale[..., None, :] + RIDGE * np.eye(p)
    inverse = np.linalg.inv(G11) * scale[..., :, None] * scale[..., None, :]
    x = (inverse @ b[..., :p, None])[..., 0]
    cost = np.maximum(groups.energy - np.sum(b[..., :p] * x, axis=-1), 0.0)
    G21 = G[..., p:, :p]
    schur = G[..., p:, p:] - G21 @ inverse @ G21.transpose(0, 1, 3, 2)
    rest = b[..., p:] - (G21 @ x[..., None])[..., 0]
    turn = _turn(x[..., : 2 * n])
    turned = turn.transpose(0, 1, 3, 2)
    return _Fits(
        poles=poles.copy(),
        cost=cost.sum(axis=1),
        information=(turned @ schur @ turn).sum(axis=1),
        score=(turned @ rest[..., None])[..., 0].sum(axis=1),
    )


def _turn(pairs: _Real) -> _Real:
    """Products with complex residues, (..., 2 n) as Re and Im, as matrices (..., 2 n, 2 n)."""
    n = pairs.shape[-1] // 2
    turn = np.zeros((*pairs.shape[:-1], 2 * n, 2 * n))
    even, odd = 2 * np.arange(n), 2 * np.arange(n) + 1
    turn[..., even, even] = turn[..., odd, odd] = pairs[..., 0::2]
    turn[..., odd, even] = pairs[..., 1::2]
    turn[..., even, odd] = -pairs[..., 1::2]
    return turn
