"""Modes whose resonance is not at the same place in every measurement.

A sensor that roves takes its mass along, a structure warms up between two batches: each mounting
then has a pole of its own, and one pole for all leaves a misfit beside every resonance. Fitted
with common poles such a mode comes out as several, each with a part of the shape.

What was measured at one point is a group of FRFs. On the lines about a mode, or about modes that
stand close enough to be copies of one another, every group is fitted with poles of its own:

* Of modes that may be copies the fewest are kept (`own_poles`).
* Whether the groups' poles differ by more than their scatter is Cochran's question (Biometrics 10
  (1954) 101): Q = sum_g (x_g - x)^2 / c_g of frequency, and of damping, is chi-square with one
  degree of freedom less than groups where only scatter c_g moves them.
* Where they do, each group's pole is x_g = x + u_g + e_g, with a variance of u beside the scatter
  (DerSimonian and Laird, Control. Clin. Trials 7 (1986) 177), and what a group can hardly see is
  drawn towards the mean.

The FRFs are then carried over to the mean pole, and the rest of the analysis sees them as if
nothing had moved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.modal.about_modes import AboutModes, about_modes, linked_runs
from armodal.analyzer.modal.own_poles import LINKED, own_fits, own_fits_again
from armodal.analyzer.modal.random_effects import Quantity, random_effects
from armodal.analyzer.modal.regression import (
    ModalData,
    Regression,
    modal_data,
    regress,
)
from armodal.analyzer.modal.uncertainty import (
    PoleCovariance,
    frequency_damping_jacobian,
    white_covariance,
)

__all__ = ["ModeDrift", "Settled", "settle_drift", "with_drift"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]
_Int = npt.NDArray[np.int64]

SURE = 1e-4  # probability of calling scatter a move, a mode
_PASSES = 4  # all but the first with the other runs at rest
_ANEW = 2  # of them in which every group is sought anew, the rest go on from there
MOST_MOVE = 2.0 * LINKED  # half bandwidths from the lowest to the highest group of one mode
REACH = 20.0  # half bandwidths on either side, on which a group's pole is fitted
LEAST_LINES = 15  # on either side


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeDrift:
    """One mode's frequency and damping ratio over the groups."""

    f_hz: Quantity
    damping: Quantity

    @property
    def pole_rad_s(self) -> complex:
        """The mean pole."""
        return complex(_pole(self.f_hz.mean, self.damping.mean))

    @property
    def group_poles(self) -> _Complex:
        """Pole of every group, drawn: (n_groups,)."""
        return np.asarray(_pole(self.f_hz.drawn, self.damping.drawn))


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """FRFs as if no mode had moved, and how those moved that did."""

    values: _Complex  # (n_frf, n_freq)
    poles: _Complex  # (n_modes,) copies put together
    kept: npt.NDArray[np.intp]  # (n_modes,) which of the poles given each stands for
    drift: tuple[ModeDrift | None, ...]  # (n_modes,)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Run:
    """Modes that stand near one another."""

    given: list[int]  # which of the poles given
    poles: _Complex  # where they are, the means if they move
    drift: tuple[ModeDrift, ...]  # empty: they do not
    carried: _Complex | None  # (n_frf, n_freq) what brings the FRFs to the means


def _pole(f_hz: _Real | float, damping: _Real | float) -> _Complex:
    w, z = 2.0 * np.pi * np.asarray(f_hz), np.asarray(damping)
    return np.asarray(w * (-z + 1j * np.sqrt(np.maximum(1.0 - z**2, 0.0))))


def _modes_of(local: AboutModes, fits: list[Regression], line_share: float) -> list[ModeDrift]:
    """Each mode over the groups, by rising frequency."""
    n_groups, n = len(fits), fits[0].poles.size
    f, z = np.empty((n_groups, n)), np.empty((n_groups, n))
    std = np.full((n_groups, n, 2), np.inf)
    low, high = local.data.s.imag[[0, -1]]
    for g, fit in enumerate(fits):
        rank = np.argsort(fit.poles.imag)
        poles = fit.poles[rank]
        f[g], z[g] = np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)
        if np.any((poles.imag < low) | (poles.imag > high)):
            continue
        n_frf = fit.n_measured
        free = n_frf * (2 * local.data.s.size - 2 * n - local.data.n_terms) - 2 * n
        noise = float(fit.cost.sum()) / max(free, 1)
        theta = white_covariance(fit.information.sum(axis=0), noise, line_share)
        J = frequency_damping_jacobian(fit.poles)
        variance = np.diag(J @ theta @ J.T).reshape(n, 2)[rank]
        # A resonance known to no better than its own width was not seen. Nor one that explains no
        # more than the best place for a pole does where there is nothing but noise, as at a node.
        explained = fit.gain.sum(axis=0) / max(noise, np.finfo(float).tiny) * line_share
        by_noise = REACH * scipy.special.chdtrc(
            2 * n_frf + 2, np.maximum(explained, 0.0)
        )  # of so many bandwidths, one
        known = (variance[:, 1] < z[g] ** 2) & (by_noise[rank] < SURE)
        std[g][known] = np.sqrt(np.maximum(variance[known], 0.0))
    return [
        ModeDrift(
            f_hz=random_effects(f[:, m], std[:, m, 0]),
            damping=random_effects(z[:, m], std[:, m, 1]),
        )
        for m in range(n)
    ]


def _chances(fit: Regression, group: _Int, n_freq: int, line_share: float) -> _Real:
    """Chance, mode by mode, that scatter alone sets the groups' poles apart; one step each."""
    n_groups, n = int(group.max()) + 1, fit.poles.size
    member = (group[None, :] == np.arange(n_groups)[:, None]).astype(float)
    A, s = np.tensordot(member, fit.information, axes=1), member @ fit.score
    n_frf, cost = member @ fit.measured, member @ fit.cost
    # Below the rounding of what is explained, what is left tells nothing of a scatter.
    rounding = np.finfo(float).eps * (member @ fit.gain.sum(axis=1))
    kappa = (
        np.maximum(cost, rounding + np.finfo(float).tiny)
        / np.maximum(n_frf * (2 * n_freq - 2 * n - fit.residuals.shape[1]) - 2 * n, 1)
        / line_share
    )
    chance = np.ones(n)
    for m in range(n):
        at = slice(2 * m, 2 * m + 2)
        own = A[:, at, at] / kappa[:, None, None]
        score = s[:, at] / kappa[:, None]
        mean = np.linalg.solve(own.sum(axis=0), score.sum(axis=0))
        own_step = np.linalg.pinv(own, hermitian=True) @ score[..., None]
        step = own_step[..., 0] - mean
        q = float(np.einsum("gi,gij,gj->", step, own, step))
        chance[m] = scipy.special.chdtrc(2 * (n_groups - 1), max(q, 0.0))
    return chance


def settle_drift(
    data: ModalData,
    fit: Regression,
    group: npt.NDArray[np.int64],
    *,
    line_share: float,
    put_together: bool = True,
    searched: bool = False,
) -> Settled | None:
    """Put copies of drifting modes together, and FRFs to where the mean pole is.

    Parameters
    ----------
    data, fit
        The FRFs, one row an FRF, and the common poles chosen for them.
    group
        (n_frf,) group of each row, from 0: what was measured at once.
    line_share
        Independent lines per line under the window.
    put_together
        Copies of a mode; False leaves runs of near modes as they were given.
    searched
        Modes that stand still were looked for already: a mode alone that seems to move does.

    Returns
    -------
    Settled or None
        None where nothing moves and nothing is a copy.
    """
    if int(group.max()) == 0 or fit.poles.size == 0:
        return None
    chance = _chances(fit, group, data.s.size, line_share)
    runs = [
        _Run(given=own, poles=fit.poles[own], drift=(), carried=None)
        for own in linked_runs(fit.poles, LINKED)
    ]
    tried = [
        put_together if len(run.given) > 1 else bool(chance[run.given[0]] < SURE) for run in runs
    ]
    if not any(tried):
        return None
    rest, still = data, fit
    at = [np.array(run.given, dtype=np.intp) for run in runs]
    for number in range(_PASSES):
        runs = [
            _looked_at(
                rest,
                still,
                own,
                run,
                group,
                line_share=line_share,
                anew=number < _ANEW,
                searched=searched,
            )
            if try_it
            else run
            for run, own, try_it in zip(runs, at, tried, strict=True)
        ]
        if not any(run.drift or run.poles.size < len(run.given) for run in runs):
            return None
        if number + 1 >= _ANEW:
            tried = [bool(run.drift) for run in runs]
        carried = [run.carried for run in runs if run.carried is not None]
        rest = _with(data, data.values + sum(carried)) if carried else data
        still = regress(rest, np.concatenate([run.poles for run in runs]), pole_terms=False)
        ends = np.cumsum([run.poles.size for run in runs])
        at = [np.arange(e - run.poles.size, e) for run, e in zip(runs, ends, strict=True)]
    return Settled(
        values=rest.values,
        poles=np.concatenate([run.poles for run in runs]),
        kept=np.concatenate([run.given[: run.poles.size] for run in runs]).astype(np.intp),
        drift=tuple(mode for run in runs for mode in run.drift or (None,) * run.poles.size),
    )


def _with(data: ModalData, values: _Complex) -> ModalData:
    """The same lines, weights and background with other values."""
    return modal_data(data.form, data.s, values, data.variance, data.background)


def _looked_at(
    data: ModalData,
    still: Regression,
    own: npt.NDArray[np.intp],
    run: _Run,
    group: _Int,
    *,
    line_share: float,
    anew: bool,
    searched: bool,
) -> _Run:
    """The run with poles of every group, if its modes move; in `data` all runs are at rest."""
    if run.carried is not None:
        data = _with(data, data.values - run.carried)
    local = about_modes(
        data, still, own, reach=REACH, least_lines=LEAST_LINES, independent=line_share >= 1.0
    )
    fits = (
        own_fits(local, group, run.poles, line_share, searched=searched)
        if anew
        else own_fits_again(local, group, np.array([mode.group_poles for mode in run.drift]))
    )
    if fits is None:
        return replace(run, drift=(), carried=None)
    found = _modes_of(local, fits, line_share)
    moved = [min(mode.f_hz.chance, mode.damping.chance) < SURE for mode in found]
    if len(found) == len(run.given) and not any(moved):
        return replace(run, drift=(), carried=None)
    if any(np.ptp(m.f_hz.drawn) > MOST_MOVE * m.f_hz.mean * m.damping.mean for m in found):
        return replace(run, drift=(), carried=None)  # several resonances, not one that moves
    return _Run(
        given=run.given,
        poles=np.array([mode.pole_rad_s for mode in found]),
        drift=tuple(found),
        carried=_carried(local, group, data.s, found),
    )


def _carried(local: AboutModes, group: _Int, s: _Complex, found: list[ModeDrift]) -> _Complex:
    """What the FRFs change by when every group's poles go to the means: (n_frf, n_freq)."""
    change = np.empty((group.size, s.size), dtype=np.complex128)
    means = np.array([mode.pole_rad_s for mode in found])
    for g in range(int(group.max()) + 1):
        own = np.array([mode.group_poles[g] for mode in found])
        residues = regress(local.of(group == g), own, pole_terms=False).residues
        both = np.concatenate([residues, residues.conj()], axis=1)
        here, there = (np.concatenate([p, p.conj()]) for p in (own, means))
        change[group == g] = both @ (1.0 / (s - there[:, None]) - 1.0 / (s - here[:, None]))
    return change


def with_drift(precision: PoleCovariance, drift: Sequence[ModeDrift | None]) -> PoleCovariance:
    """Covariance of frequencies and dampings where some are means over groups that differ.

    The variances of those are the means' own, correlations stay.
    """
    std = np.sqrt(np.diag(precision.covariance))
    dof = precision.dof.copy()
    ratio = np.ones(std.size)
    for m, mode in enumerate(drift):
        for at, quantity in () if mode is None else ((0, mode.f_hz), (1, mode.damping)):
            ratio[2 * m + at] = quantity.std / max(std[2 * m + at], np.finfo(float).tiny)
            dof[2 * m + at] = max(int(np.isfinite(quantity.value_std).sum()) - 1, 1)
    return replace(precision, covariance=precision.covariance * np.outer(ratio, ratio), dof=dof)
