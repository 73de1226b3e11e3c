"""Which candidate poles the data need.

Candidates are generous; the regression decides. Without a mode the weighted misfit rises by its
gain; noise alone would give two real parameters an FRF. A mode stays when its gain is beyond
doubt, when it carries a visible part of the FRFs at its own frequency, when its pole is
determined, and when it is not a second copy of a neighbour.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.about_modes import about_modes
from armodal.analyzer.modal.choice import physical
from armodal.analyzer.modal.correlation import mac
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import ModalData, Regression, regress
from armodal.analyzer.modal.significance import (
    LEAST_SIGNIFICANCE,
    noise_about,
    significance,
    worth,
)
from armodal.analyzer.modal.uncertainty import frequency_damping_jacobian, white_covariance

__all__ = [
    "Kept",
    "Selection",
    "keep_modes",
    "off_resonance",
    "second_poles",
    "select_modes",
    "still_needed",
]

_DOUBTFUL_SIGNIFICANCE = 1000.0
_LEAST_VISIBLE = 0.05  # of the FRFs' weighted amplitude at the mode's own frequency
_MOST_DAMPING_STD = 0.5  # of the damping ratio
_LEAST_GAIN = 0.1  # of the way to where a mode is not needed, a step: else it is needed
_NEAR = 10.0  # half bandwidths of the wider of two, within which they may stand in for one another
_NEAR_LINES = 15  # on either side at least, where neighbours are to make up for a mode
_PART_OF_PEAK = 3.0  # half bandwidths from where a second pole was tried to both that are found
_LEFT = 6.0  # half bandwidths, of the narrower, beyond which a pole is no longer on its resonance
_LEFT_LINES = 2.0  # added: what is narrower than a line is placed to no better
_OWN_REACH, _OWN_LINES = 4.0, 6  # half bandwidths and lines at least on either side of a resonance
_DUPLICATE_MAC = 0.9
_DUPLICATE_DISTANCE = 1.0  # in half bandwidths of the wider of the two, or lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """The poles that stayed, refined."""

    fit: Regression
    share: npt.NDArray[np.float64]  # (n_modes,) stability of each


@dataclass(frozen=True, slots=True, kw_only=True)
class Kept(Selection):
    """Poles refined of which none was dropped."""

    significance: npt.NDArray[np.float64]  # (n_modes,)
    given: npt.NDArray[np.intp]  # (n_modes,) which of the poles given each is
    held: npt.NDArray[np.bool_]  # (n_modes,) where the lines about it have it, not all lines


def _visible(fit: Regression, data: ModalData) -> npt.NDArray[np.float64]:
    """Weighted amplitude of each mode over that of the FRFs at its own frequency: (n_modes,)."""
    line = np.argmin(np.abs(data.s.imag[:, None] - fit.poles.imag), axis=0)  # (n_modes,)
    weight = data.row_weight[:, None] * data.weight[:, line]
    own = np.abs(fit.residues / (data.s[line] - fit.poles)) ** 2
    all_of_it = np.abs(data.values[:, line]) ** 2
    result: npt.NDArray[np.float64] = np.sqrt(
        (weight * own).sum(axis=0) / np.maximum((weight * all_of_it).sum(axis=0), 1e-300)
    )
    return result


def _duplicate_of_a_stronger(
    fit: Regression, significance: npt.NDArray[np.float64], line_rad_s: float
) -> int | None:
    """Index of a mode that repeats a stronger neighbour, or None.

    Of one shape, two resonances closer than their width or than a line are not told apart.
    """
    order = np.argsort(significance)
    for weak in order:
        for other in range(fit.poles.size):
            if other == weak or significance[other] < significance[weak]:
                continue
            reach = max(-fit.poles[weak].real, -fit.poles[other].real, line_rad_s)
            if abs(fit.poles[weak] - fit.poles[other]) > _DUPLICATE_DISTANCE * reach:
                continue
            both = fit.residues[:, weak], fit.residues[:, other]
            if np.any(both[0]) and np.any(both[1]) and mac(*both) > _DUPLICATE_MAC:
                return int(weak)
    return None


def _weakest(
    fit: Regression, data: ModalData, band_hz: tuple[float, float], share: float, *, strict: bool
) -> list[int]:
    """The modes to drop next, none of them near another; none when all may stay."""
    noise = noise_about(data, fit)
    told = significance(fit, noise, share)
    bad = told < LEAST_SIGNIFICANCE
    if strict:
        bad |= ~physical(fit.poles, band_hz)
        bad |= _visible(fit, data) < _LEAST_VISIBLE
        J = frequency_damping_jacobian(fit.poles)
        covariance = white_covariance(fit.information.sum(axis=0), 1.0, share)
        variance = np.diag(J @ covariance @ J.T)[1::2] * noise
        damping = -fit.poles.real / np.abs(fit.poles)
        bad |= np.sqrt(np.maximum(variance, 0.0)) > _MOST_DAMPING_STD * np.abs(damping)
    drop: list[int] = []
    for index in (int(i) for i in np.argsort(told) if bad[i]):
        if not np.any(_near(fit.poles[drop], complex(fit.poles[index]))):
            drop.append(index)
    if drop or not strict:
        return drop
    line_rad_s = float(np.median(np.diff(data.s.imag)))
    copy = _duplicate_of_a_stronger(fit, told, line_rad_s)
    return [] if copy is None else [copy]


def _not_needed(
    fit: Regression, data: ModalData, line_share: float, settled: npt.NDArray[np.bool_]
) -> tuple[int, Regression] | None:
    """A doubtful mode the others make up for once they may move, and the fit without it.

    Two poles can split one mode between them, each seeming needed while the other stands where
    it is. The likelihood ratio after a new refinement tells, first on the lines about the mode
    where only its neighbours move: what these cannot make up for, those farther off cannot.
    Modes found to be needed are noted in `settled`.
    """
    noise = noise_about(data, fit)
    told = significance(fit, noise, line_share)

    def enough(most: float) -> Callable[[float, float], bool]:
        return lambda before, after: after < most or before - after < _LEAST_GAIN * (after - most)

    for index in np.argsort(told):
        if told[index] > _DOUBTFUL_SIGNIFICANCE:
            return None
        if settled[index]:
            continue
        settled[index] = True
        near = np.flatnonzero(_near(fit.poles, complex(fit.poles[index])))
        local = _about(data, fit, near, line_share)
        least = worth(fit.n_measured, float(noise[index]), line_share)
        most = float(refine_poles(local, fit.poles[near]).cost.sum()) + least
        start = fit.poles[near[near != index]]
        without = refine_poles(local, start, enough=enough(most))
        if float(without.cost.sum()) >= most:
            continue
        others = fit.poles.copy()
        others[near[near != index]] = without.poles
        most = float(fit.cost.sum()) + least
        without = refine_poles(data, np.delete(others, index), enough=enough(most))
        if float(without.cost.sum()) < most:
            return int(index), refine_poles(data, without.poles)
    return None


def _roughly(before: float, after: float) -> bool:
    """Whether poles are near enough to where they will end to tell which are worth keeping."""
    return before - after < _LEAST_GAIN * after


def _without(fit: Regression, data: ModalData, drop: list[int], line_share: float) -> Regression:
    """The fit without some modes, their neighbours moved to where the lines about have them."""
    poles = fit.poles.copy()
    for index in drop:
        near = np.flatnonzero(_near(fit.poles, complex(fit.poles[index])))
        left = near[near != index]
        # A pole that has left the band has no lines about it.
        if left.size and data.s.imag[0] <= fit.poles[index].imag <= data.s.imag[-1]:
            local = _about(data, fit, near, line_share)
            poles[left] = refine_poles(local, fit.poles[left], enough=_roughly).poles
    return regress(data, np.delete(poles, drop))


def second_poles(
    data: ModalData, fit: Regression, tried: Sequence[complex], line_share: float
) -> npt.NDArray[np.complex128]:
    """Of poles tried beside modes those that the lines about them are worth: (n,).

    A pole that ends more than three half bandwidths from where it was tried, or leaves no other
    there, rounds the background and is no part of that peak. Of poles that overlap the first
    stays: what it leaves can be looked at again.
    """
    found: list[complex] = []
    for pole in tried:
        if np.any(_near(np.array(found, dtype=np.complex128), pole)):
            continue
        near = np.flatnonzero(_near(fit.poles, pole))
        local = _about(data, fit, near, line_share)
        before = refine_poles(local, fit.poles[near])
        after = refine_poles(local, np.append(before.poles, pole))
        gain = float(before.cost.sum() - after.cost.sum())
        noise = float(noise_about(local, after)[-1])
        parts = np.abs(after.poles - pole) < _PART_OF_PEAK * -pole.real
        if gain > worth(fit.n_measured, noise, line_share) and parts[-1] and parts.sum() > 1:
            found.append(pole)
    return np.array(found, dtype=np.complex128)


def _about(
    data: ModalData, fit: Regression, own: npt.NDArray[np.intp], line_share: float
) -> ModalData:
    """The lines about some modes, the others taken off."""
    return about_modes(
        data, fit, own, reach=_NEAR, least_lines=_NEAR_LINES, independent=line_share >= 1.0
    ).data


def _near(poles: npt.NDArray[np.complex128], pole: complex) -> npt.NDArray[np.bool_]:
    """Poles whose resonances overlap with that of `pole`."""
    reach = _NEAR * np.maximum(-poles.real, -pole.real)
    result: npt.NDArray[np.bool_] = np.abs(poles.imag - pole.imag) < reach
    return result


def select_modes(
    data: ModalData,
    poles: npt.NDArray[np.complex128],
    stability: npt.NDArray[np.float64],
    band_hz: tuple[float, float],
    *,
    line_share: float,
    chosen: Selection | None = None,
) -> Selection:
    """Keep the candidates the data need and refine them to maximum likelihood.

    Parameters
    ----------
    data
        FRFs weighted by one over their variance.
    poles, stability
        (n,) candidates in rad/s and the share of orders each was seen at.
    band_hz
        Band the frequencies must stay in.
    line_share
        Independent lines per line under the window.
    chosen
        An earlier choice, its poles among the candidates: tried again only where there are new
        ones near.

    Returns
    -------
    Selection
        Possibly of no modes.
    """
    share = stability
    settled = np.zeros(poles.size, dtype=bool)
    if chosen is not None:
        settled = np.isin(poles, chosen.fit.poles)
        for pole in poles[~settled]:
            settled &= ~_near(poles, pole)
    fit = regress(data, poles, pole_terms=False)
    while poles.size:
        drop = _weakest(fit, data, band_hz, line_share, strict=False)
        if not drop:
            break
        poles, share, settled = (np.delete(a, drop) for a in (poles, share, settled))
        fit = regress(data, poles, pole_terms=False)
    fit, moved = refine_poles(data, poles, enough=_roughly), True
    while fit.poles.size:
        drop = _weakest(fit, data, band_hz, line_share, strict=True)
        if drop:
            for pole in fit.poles[drop]:
                settled &= ~_near(fit.poles, complex(pole))
            share, settled = np.delete(share, drop), np.delete(settled, drop)
            fit, moved = _without(fit, data, drop, line_share), True
            continue
        if moved:
            fit, moved = refine_poles(data, fit.poles), False
            continue
        spare = _not_needed(fit, data, line_share, settled)
        if spare is None:
            break
        index, reduced = spare
        settled &= ~_near(fit.poles, complex(fit.poles[index]))
        share, settled = np.delete(share, index), np.delete(settled, index)
        fit = reduced
    rank = np.argsort(np.abs(fit.poles), kind="stable")
    if np.any(rank != np.arange(rank.size)):
        fit, share = regress(data, fit.poles[rank]), share[rank]
    return Selection(fit=fit, share=share)


def keep_modes(
    data: ModalData,
    poles: npt.NDArray[np.complex128],
    stability: npt.NDArray[np.float64],
    *,
    line_share: float,
) -> Kept:
    """Refine exactly the poles given, dropping none; the significance tells what each is worth.

    A faint mode's pole may serve the others' misfit better far from its resonance. One that leaves
    its resonance is held where the lines about it have it.

    Parameters
    ----------
    data
        FRFs weighted by one over their variance.
    poles, stability
        (n,) poles in rad/s and the share of orders each was seen at.
    line_share
        Independent lines per line under the window.
    """
    start, held = poles, np.zeros(poles.size, dtype=bool)
    fit = refine_poles(data, start)
    while np.any(left := ~held & _left(start, fit.poles, data)):
        place = regress(data, start, pole_terms=False)
        start = start.copy()
        for index in np.flatnonzero(left):
            start[index] = _on_its_lines(data, place, int(index))
        held |= left
        fit = refine_poles(data, start, held=held)
    given = np.argsort(np.abs(fit.poles), kind="stable")
    fit = regress(data, fit.poles[given])
    return Kept(
        fit=fit,
        share=stability[given],
        significance=significance(fit, noise_about(data, fit), line_share),
        given=given,
        held=held[given],
    )


def still_needed(
    data: ModalData,
    poles: npt.NDArray[np.complex128],
    stability: npt.NDArray[np.float64],
    band_hz: tuple[float, float],
    *,
    line_share: float,
) -> Kept:
    """Refine the poles given, and drop those that these weights show to be none.

    Weights that the misfit tells may give another answer than those a search began with.
    Parameters as of `select_modes`.
    """
    at = np.arange(poles.size)
    while True:
        kept = keep_modes(data, poles[at], stability[at], line_share=line_share)
        drop = _weakest(kept.fit, data, band_hz, line_share, strict=True)
        if not drop:
            return replace(kept, given=at[kept.given])
        at = np.delete(at, kept.given[drop])


def off_resonance(
    poles: npt.NDArray[np.complex128], distance_hz: npt.NDArray[np.float64], data: ModalData
) -> npt.NDArray[np.bool_]:
    """Whether so far from a pole (n,) is off its resonance: (n,)."""
    lines = _LEFT_LINES * float(np.median(np.diff(data.s.imag)))
    result: npt.NDArray[np.bool_] = 2.0 * np.pi * distance_hz > _LEFT * -poles.real + lines
    return result


def _left(
    start: npt.NDArray[np.complex128], end: npt.NDArray[np.complex128], data: ModalData
) -> npt.NDArray[np.bool_]:
    """Which poles are no longer on the resonance they came from."""
    narrower = np.where(end.real > start.real, end, start)
    return off_resonance(narrower, np.abs(end - start) / (2.0 * np.pi), data)


def _on_its_lines(data: ModalData, fit: Regression, index: int) -> complex:
    """The pole that the lines about a mode have, the other modes taken off; its own if none."""
    own = np.array([index], dtype=np.intp)
    local = about_modes(data, fit, own, reach=_OWN_REACH, least_lines=_OWN_LINES).data
    again = refine_poles(local, fit.poles[own]).poles
    return complex(fit.poles[index] if _left(fit.poles[own], again, local)[0] else again[0])
