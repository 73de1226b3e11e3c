"""Every group's own poles about some modes, and how many poles a group needs.

Of modes that may be copies of one that moves the fewest are kept with which nothing is left over
that could be seen as a mode, if they are believed rather than more that stand still.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.modal.about_modes import AboutModes
from armodal.analyzer.modal.correlation import mpc
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.refine_each import refine_each
from armodal.analyzer.modal.regression import ModalData, Regression, misfit, regress

__all__ = ["LINKED", "own_fits", "own_fits_again"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]
_Int = npt.NDArray[np.int64]

LINKED = 6.0  # half bandwidths between neighbours that may be copies: two, of those two apart, more
VISIBLE = 0.05  # of the FRFs' weighted amplitude at a mode: less is no mode of its own
CONSISTENT = 0.8  # MPC of a mode to be trusted: Pappa, Elliott, Schenk, J. Guidance 16 (1993) 860
_LINES_OF_PEAK = 8  # of its bandwidth, that tell the start to begin from
_FIRST = 4  # groups, of those that show most, that may tell that poles are too few
_STARTS = 3  # of a group's own poles: the misfit over their place has several hollows


def own_fits(
    local: AboutModes, group: _Int, poles: _Complex, line_share: float, *, searched: bool
) -> list[Regression] | None:
    """Own fits with the fewest poles that explain what these common poles do.

    None where all are needed and common poles leave nothing visible. What fewer poles leave over
    counts for as much as it is a mode: not at a common pole whose shape no mode can have, if own
    poles make no modes of these either. Fewer poles that move are believed by Akaike's criterion;
    or because they have shapes that a mode can have, those that stand still have not, and leave
    more than noise: every lineshape is approximated by enough fixed poles.
    """
    common = regress(local.data, poles, pole_terms=False)
    reference = _at_modes(local, misfit(local.data, common))
    visible = VISIBLE**2 * _at_modes(local, local.data.values)
    any_left = np.full(poles.size, np.inf)
    no_mode = _consistency(local, common.residues) < CONSISTENT
    every = _own_fits(local, group, poles, poles.size, any_left) if no_mode.any() else None
    most = reference + visible
    if every is not None and not _is_mode(local, _moving(local, group, every[0])):
        most[no_mode] = np.inf
    # Shapes of any phases may be the structure's own, where common poles leave nothing but noise.
    doubted = every is not None and _aic(local, every[0], common, line_share)
    for n in range(1, poles.size):
        own = _own_fits(local, group, poles, n, most)
        if own is None:
            continue
        if _aic(local, own[0], common, line_share) or (
            doubted and _is_mode(local, _moving(local, group, own[0]))
        ):
            return own[0]
    if np.all(reference < visible):
        return None  # no other poles can leave visibly less
    every = every or _own_fits(local, group, poles, poles.size, any_left)
    if every is None or np.all(reference - every[1] < visible):
        return None
    if searched:
        return every[0]
    rival = _one_more(local.data, poles)
    moving = _is_mode(local, _moving(local, group, every[0])) and not _is_mode(
        local, rival.residues
    )
    return every[0] if moving or _aic(local, every[0], rival, line_share) else None


def own_fits_again(local: AboutModes, group: _Int, starts: _Complex) -> list[Regression]:
    """Every group from where its poles were: starts (n, n_groups)."""
    poles, _ = refine_each(local.data, group, starts.T[None])
    return [regress(local.of(group == g), own) for g, own in enumerate(poles[0])]


def _own_fits(
    local: AboutModes, group: _Int, poles: _Complex, n: int, most: _Real
) -> tuple[list[Regression], _Real] | None:
    """Every group with `n` poles of its own, and what is left at each mode; None beyond `most`.

    Each begins from those of the poles given that suit it best; where these are no more than
    wanted, moved by the number of half bandwidths that suits it best. The groups that show most
    come first.
    """
    half = float(np.max(-poles.real))
    moves = np.arange(-2.0 * LINKED, 2.0 * LINKED + 1.0) if n == poles.size else np.zeros(1)
    starts = np.array(
        [
            poles[list(chosen)] + 1j * half * move
            for chosen in combinations(range(poles.size), n)
            for move in moves
        ]
    )
    shown = np.bincount(group, np.sum(np.abs(local.data.values) ** 2 / local.variance, axis=1))
    every = max(int(local.core.sum(axis=1).min()) // _LINES_OF_PEAK, 1)
    few = local.of(np.ones(group.size, dtype=bool), every=every) if every > 1 else local.data
    costs = np.array(
        [np.bincount(group, regress(few, start, pole_terms=False).cost) for start in starts]
    )
    best = np.argsort(costs, axis=0)[:_STARTS]  # (n_starts, n_groups)
    order = np.argsort(-shown)
    fits: dict[int, Regression] = {}
    left = np.zeros(poles.size)
    for which in (order[:_FIRST], order[_FIRST:]):
        if not which.size:
            break
        part = np.full(shown.size, -1)
        part[which] = np.arange(which.size)
        own, cost = refine_each(few, part[group], starts[best[:, which]])
        ends = own[np.argmin(cost, axis=0), np.arange(which.size)]
        if every > 1:
            ends = refine_each(local.data, part[group], ends[None])[0][0]
        for g, end in zip(which, ends, strict=True):
            fits[int(g)] = regress(local.of(group == g), end)
            left += _at_modes(local, misfit(local.of(group == g), fits[int(g)]), group == g)
        if np.any(left >= most):
            return None
    return [fits[g] for g in range(len(fits))], left


def _at_modes(
    local: AboutModes, values: _Complex, rows: npt.NDArray[np.bool_] | slice = slice(None)
) -> _Real:
    """Weighted power of values (n_rows, n_lines) on the core lines of each mode: (n_modes,)."""
    power: _Real = local.core @ np.sum(np.abs(values) ** 2 / local.variance[rows], axis=0)
    return power


def _consistency(local: AboutModes, residues: _Complex) -> _Real:
    """MPC of these (n_frf, n): (n,).

    In units of each FRF's noise: what a noisy FRF or a strong reference tells of a phase counts for
    no more than it is known.
    """
    known = np.sqrt(local.data.row_weight)
    return np.array([mpc(known * shape) for shape in residues.T])


def _is_mode(local: AboutModes, residues: _Complex) -> bool:
    """Whether all these (n_frf, n) are shapes that a mode can have."""
    return bool(_consistency(local, residues).min() >= CONSISTENT)


def _moving(local: AboutModes, group: _Int, fits: list[Regression]) -> _Complex:
    """Residues (n_frf, n) of own fits, poles paired with those of the group that shows most.

    A pole counts by what it shows: a faint one that rounds off the lineshape of another may
    stand on either side of it.
    """
    row = local.data.row_weight
    shown = [row[group == g] @ np.abs(fit.residues) ** 2 for g, fit in enumerate(fits)]
    most = fits[int(np.argmax([one.sum() for one in shown]))].poles
    moving = np.empty((group.size, most.size), dtype=np.complex128)
    for g, fit in enumerate(fits):
        apart = shown[g] * np.abs(most[:, None] - fit.poles) ** 2
        moving[group == g] = fit.residues[:, scipy.optimize.linear_sum_assignment(apart)[1]]
    return moving


def _one_more(data: ModalData, poles: _Complex) -> Regression:
    """The best fit with one more pole that stands still, somewhere near: a mode not yet found."""
    half = float(np.max(-poles.real))
    moves = 1j * half * np.arange(-2.0 * LINKED - 0.5, 2.0 * LINKED + 1.0)
    starts = [np.append(poles, pole + move) for pole in poles for move in moves]
    costs = [regress(data, start, pole_terms=False).cost.sum() for start in starts]
    return refine_poles(data, starts[int(np.argmin(costs))])


def _aic(local: AboutModes, fits: list[Regression], common: Regression, line_share: float) -> bool:
    """Whether poles that move are believed rather than some that stand still.

    By Akaike's criterion (IEEE Trans. Autom. Control 19 (1974) 716).
    """
    n_frf, lines = common.n_measured, local.data.s.size
    n_groups, n, more = len(fits), fits[0].poles.size, common.poles.size
    n_terms = local.data.n_terms
    size_own = 2 * n * n_groups + n_frf * (2 * n + n_terms)
    size_common = 2 * more + n_frf * (2 * more + n_terms)
    cost_own = sum(float(fit.cost.sum()) for fit in fits)
    cost_common = float(common.cost.sum())
    real = 2 * n_frf * lines
    noise = (
        min(cost_own / max(real - size_own, 1), cost_common / max(real - size_common, 1))
        / line_share
    )
    return cost_own / noise + 2 * size_own < cost_common / noise + 2 * size_common
