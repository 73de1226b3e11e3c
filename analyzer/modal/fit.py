"""From an FRF matrix to modes with uncertainty, without a starting guess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.assemble import assemble_model, mountings
from armodal.analyzer.modal.background import with_background_found
from armodal.analyzer.modal.drift import ModeDrift, settle_drift
from armodal.analyzer.modal.lines import FittedLines, fitted_lines, misfit_variance
from armodal.analyzer.modal.modes import ModalModel
from armodal.analyzer.modal.places import without_place
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.modal.rank_one import refine_rank_one
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import ModalData, misfit, regress
from armodal.analyzer.modal.search import Problem, search_poles, stabilisation
from armodal.analyzer.modal.selection import keep_modes, off_resonance, still_needed
from armodal.analyzer.modal.significance import lack_of_fit
from armodal.analyzer.modal.spread import pole_spread
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["fit_modes", "fit_modes_at"]

BEYOND_NOISE = 4.0  # of the misfit's power over the noise's: the model's error exceeds the noise


def _silent(_doing: str) -> None:
    """Tell nobody."""


def fit_modes(
    frf: FrequencyResponse,
    *,
    band_hz: tuple[float, float] | None = None,
    max_order: int = 60,
    tell: Callable[[str], None] = _silent,
) -> ModalModel:
    """Poles, shapes and residual terms of one FRF matrix.

    Poles over model orders by pLSCF, candidates where they gather, choice by what the data need,
    then a weighted least-squares fit of the whole model to the FRFs.

    Parameters
    ----------
    frf
        FRFs of any form, weighted by their variance.
    band_hz
        Lines used, and where modes may lie; all lines by default. `proposed_band` gives those
        that carry a signal.
    max_order
        Highest order of the stabilisation.
    tell
        Called with what is being done, whenever that changes.

    Returns
    -------
    ModalModel
        Modes by increasing frequency. No modes is a valid answer.

    Raises
    ------
    EstimateError
        If the FRFs cannot be fitted; `partial` then holds the stabilisation data if reached.

    References
    ----------
    `docs/theory-modal.md`.
    """
    lines = fitted_lines(frf, band_hz)
    problem, transposed = _problem(frf, lines)
    table: Stabilisation | None = None
    try:
        tell("poles over model orders")
        table = stabilisation(problem, max_order)
        poles, share = search_poles(problem, table, max_order, tell=tell)
        poles, background = with_background_found(
            problem.data(), poles, problem.band_hz, line_share=problem.line_share
        )
        problem = replace(problem, background=background)
        tell(f"whether {poles.size} modes move, and where they are")
        problem, data = _reweighted(problem, poles, told=lines.told)
        return _fitted(frf, lines, problem, data, table, poles, share, transposed=transposed)
    except np.linalg.LinAlgError as error:
        raise _singular(frf, error, table) from error


def fit_modes_at(
    frf: FrequencyResponse,
    poles_rad_s: npt.ArrayLike,
    stabilisation: Stabilisation,
) -> ModalModel:
    """Shapes, refined poles and residual terms from poles picked by hand.

    Every pole given is kept and refined to the least weighted misfit; none is added, of a
    background neither: beside a few modes it would take on those that were not picked.

    Parameters
    ----------
    frf
        FRFs of any form, weighted by their variance.
    poles_rad_s
        (n,) starting poles, imaginary parts above zero.
    stabilisation
        The poles over model orders they were picked from; carried into the result.

    Raises
    ------
    EstimateError
        If a pole is unstable or outside the band, or the FRFs cannot be fitted.
    """
    lines = fitted_lines(frf, None)
    poles = np.asarray(poles_rad_s, dtype=np.complex128).reshape(-1)
    f_hz = np.abs(poles) / (2.0 * np.pi)
    low, high = lines.band_hz
    # Written so that NaN is refused too.
    bad = ~((poles.real < 0.0) & (poles.imag > 0.0) & (f_hz >= low) & (f_hz <= high))
    if np.any(bad):
        raise EstimateError(
            f"posture {frf.posture!r}: wanted stable poles from {low:.4g} to {high:.4g} Hz, got "
            f"{poles[bad][0]:.4g} rad/s; pick another pole or widen the band"
        )
    seen = np.array([_share_of_orders(stabilisation, pole) for pole in poles])
    problem, transposed = _problem(frf, lines)
    try:
        # A pole picked is some order's, not yet where the FRFs have it.
        poles = refine_poles(problem.data(), poles).poles
        problem, data = _reweighted(problem, poles, told=lines.told, put_together=False)
        return _fitted(
            frf,
            lines,
            problem,
            data,
            stabilisation,
            poles,
            seen,
            transposed=transposed,
            put_together=False,
        )
    except np.linalg.LinAlgError as error:
        raise _singular(frf, error, stabilisation) from error


def _share_of_orders(table: Stabilisation, pole: complex) -> float:
    """Share of the model orders with a pole within 1 % of this one."""
    near = np.abs(table.pole_rad_s - pole) <= 0.01 * abs(pole)
    return len(np.unique(table.order[near])) / max(len(table.orders), 1)


def _problem(frf: FrequencyResponse, lines: FittedLines) -> tuple[Problem, bool]:
    """The FRFs with the longer side first, and whether that is the references'."""
    values, variance = lines.values, lines.variance
    transposed = values.shape[1] > values.shape[0]
    if transposed:
        values, variance = values.transpose(1, 0, 2), variance.transpose(1, 0, 2)
    group, _ = mountings(frf.references if transposed else frf.responses)
    problem = Problem(
        form=frf.form,
        freq_hz=lines.freq_hz,
        decay_rad_s=frf.decay_rad_s,
        values=values,
        variance=variance,
        line_share=lines.share,
        group=group,
    )
    return problem, transposed


def _reweighted(
    problem: Problem,
    poles: npt.NDArray[np.complex128],
    *,
    told: bool,
    put_together: bool = True,
) -> tuple[Problem, ModalData]:
    """The problem with the variance that the misfit of these poles tells, and its data.

    A variance that came with the FRFs stays, but where the misfit is far beyond it: leakage, a
    spring that bends or a clamp that slips are errors in proportion to the FRFs, and lines at
    which scatter or coherence know next to no noise would outweigh all others.
    """
    data = given = problem.data()
    fit = regress(data, poles, pole_terms=not told)
    if told and 2.0 * lack_of_fit(fit, data.s.size) < BEYOND_NOISE:
        return problem, given
    fit = regress(data, poles) if told else fit
    still = settle_drift(
        data,
        fit,
        problem.rows,
        line_share=problem.line_share,
        put_together=put_together,
        searched=True,
    )
    if still is not None:
        data = replace(problem, values=still.values.reshape(problem.values.shape)).data()
        fit = regress(data, still.poles, pole_terms=False)
    if told and 2.0 * lack_of_fit(fit, data.s.size) < BEYOND_NOISE:
        return problem, given
    left = misfit(data, fit).reshape(problem.values.shape)
    variance = misfit_variance(left, problem.values, problem.line_share, problem.measured)
    if told:
        variance = np.maximum(variance, problem.variance)
    problem = replace(problem, variance=variance)
    return problem, problem.data()


def _fitted(
    frf: FrequencyResponse,
    lines: FittedLines,
    problem: Problem,
    data: ModalData,
    table: Stabilisation,
    poles: npt.NDArray[np.complex128],
    share: npt.NDArray[np.float64],
    *,
    transposed: bool,
    put_together: bool = True,
) -> ModalModel:
    """Refine all poles together, where every mounting has them, and put the model together."""
    still = settle_drift(
        data,
        regress(data, poles),
        problem.rows,
        line_share=lines.share,
        put_together=put_together,
        searched=True,
    )
    if still is not None:
        problem = replace(problem, values=still.values.reshape(problem.values.shape))
        data, poles, share = problem.data(), still.poles, share[still.kept]
    drift: tuple[ModeDrift | None, ...] = (None,) * poles.size if still is None else still.drift
    at = np.arange(poles.size)
    while True:
        chosen = (
            still_needed(data, poles[at], share[at], lines.band_hz, line_share=lines.share)
            if put_together
            else keep_modes(data, poles[at], share[at], line_share=lines.share)
        )
        spread = pole_spread(data, chosen.fit, lines.share)
        # What other lines or weights put somewhere else altogether is no resonance.
        none = off_resonance(chosen.fit.poles, spread[0::2], data)
        if not (put_together and np.any(none)):
            start = chosen.fit.residues.reshape(*problem.values.shape[:2], -1)
            model = assemble_model(
                frf,
                lines,
                problem,
                table,
                chosen,
                refine_rank_one(data, chosen.fit.poles, start, fixed=chosen.held),
                drift=tuple(drift[at[i]] for i in chosen.given),
                spread=spread,
                transposed=transposed,
            )
            none = without_place(model.modes, float(np.median(np.diff(problem.freq_hz))))
            if not (put_together and np.any(none)):
                return model
        at = at[chosen.given[~none]]


def _singular(
    frf: FrequencyResponse, error: Exception, table: Stabilisation | None
) -> EstimateError:
    return EstimateError(
        f"posture {frf.posture!r}: the modal fit met a singular matrix ({error}); "
        "check for constant or repeated FRFs, or narrow the band",
        partial=table,
    )
