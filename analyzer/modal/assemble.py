"""The fitted numbers as a record: modes with shapes and uncertainties, errors of the synthesis."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.background import background_note
from armodal.analyzer.modal.correlation import frac, mcf, mpc, mpd_deg, to_real_axis
from armodal.analyzer.modal.drift import ModeDrift, with_drift
from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.lines import FittedLines
from armodal.analyzer.modal.modes import ModalModel, Mode
from armodal.analyzer.modal.noise import SMOOTHED_LINES
from armodal.analyzer.modal.peaks import standing_peaks, unexplained
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.modal.rank_one import RankOneFit
from armodal.analyzer.modal.regression import residual_terms
from armodal.analyzer.modal.search import Problem
from armodal.analyzer.modal.selection import Kept
from armodal.analyzer.modal.shape_uncertainty import (
    axis_correlation,
    common_gain_variance,
    participation_covariance,
    shape_covariance,
    turned_std,
)
from armodal.analyzer.modal.uncertainty import PoleCovariance, pole_covariance, with_spread
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.arrays import frozen_array
from armodal.protocols.frf_records import Dof, FrequencyResponse

__all__ = ["assemble_model", "mountings"]

_Complex = npt.NDArray[np.complex128]

SUSPENSION = 0.1  # of the next mode's frequency, below which a mode may be the suspension's


def mountings(dofs: tuple[Dof, ...]) -> tuple[npt.NDArray[np.int64], tuple[str, ...]]:
    """Number of each measured point, from 0: (n_resp,), and their names.

    What is measured at one point shares hits.
    """
    names: dict[str, int] = {}
    number = [names.setdefault(dof.point, len(names)) for dof in dofs]
    return np.array(number, dtype=np.int64), tuple(names)


def _synthesis(
    frf: FrequencyResponse, s: _Complex, fit: RankOneFit, background: _Complex
) -> _Complex:
    """The fitted model on its own lines: (n_resp, n_ref, n_freq)."""
    residues = fit.shape[:, None, :] * fit.participation
    both = np.concatenate([residues, residues.conj()], axis=-1)
    poles = np.concatenate([fit.poles, fit.poles.conj()])
    total: _Complex = both @ (1.0 / (s - poles[:, None]))
    total += fit.residuals @ residual_terms(frf.form, s, background).T
    return total


def _residuals(frf: FrequencyResponse, fit: RankOneFit) -> npt.NDArray[np.float64]:
    """Residual terms (n_long, n_short, n_terms); of an FRF not measured those of its modes alone.

    s^d R / (s - p) = p^d R / (s - p) + R sum over k < d of s^k p^(d-1-k), which the residual terms
    of an FRF that was measured hold already.
    """
    residuals, d = fit.residuals.copy(), derivative_order(frf.form)
    receptance = fit.shape[:, None, :] * fit.participation / fit.poles**d
    for k in range(d):
        rest = 2.0 * np.sum(receptance * fit.poles ** (d - 1 - k), axis=-1).real
        residuals[..., k - d + 2] = np.where(fit.measured, residuals[..., k - d + 2], rest)
    return residuals


def _modes(
    fit: RankOneFit,
    chosen: Kept,
    precision: PoleCovariance,
    correlation: _Complex,
    noise: float,
    power: int,
    gain_variance: npt.NDArray[np.float64],
    clusters: npt.NDArray[np.int64],
    drift: tuple[ModeDrift | None, ...],
    *,
    line_dof: float,
    gain_dof: float,
    transposed: bool,
) -> tuple[Mode, ...]:
    """Shapes of largest magnitude 1 on their best line; the participations carry the rest."""
    std = np.sqrt(np.maximum(np.diag(precision.covariance), 0.0))
    modes = []
    for m, pole in enumerate(fit.poles):
        long, short = fit.shape[:, m], fit.participation[:, m]
        turned_long, turned_short = (
            v / np.max(np.abs(v)) for v in (to_real_axis(long), to_real_axis(short))
        )
        covariance, shares = shape_covariance(
            fit,
            precision.theta,
            correlation,
            noise,
            m,
            gain_variance=float(gain_variance[m]),
            clusters=clusters,
        )
        long_std, long_scale = turned_std(long, covariance, turned_long)
        short_std, _ = turned_std(
            short, participation_covariance(fit, precision.theta, m), turned_short
        )
        k, j = int(np.argmax(np.abs(long))), int(np.argmax(np.abs(short)))
        size = long[k] * short[j] / (turned_long[k] * turned_short[j]) / pole**power
        shape, shape_std, part, part_std = turned_long, long_std, turned_short, short_std
        if transposed:
            shape, shape_std, part, part_std = part, part_std, shape, shape_std
        dof = float(precision.dof[2 * m : 2 * m + 2].min())
        modes.append(
            Mode(
                pole_rad_s=complex(pole),
                f_hz=float(abs(pole) / (2.0 * np.pi)),
                f_std_hz=float(std[2 * m]),
                damping_ratio=float(-pole.real / abs(pole)),
                damping_std=float(std[2 * m + 1]),
                shape=frozen_array(shape, np.complex128),
                shape_std=frozen_array(shape_std, np.complex128),
                participation=frozen_array(size * part, np.complex128),
                participation_std=frozen_array(abs(size) * part_std, np.complex128),
                residue_std=long_scale,
                mpc=mpc(turned_long),
                mpd_deg=mpd_deg(turned_long),
                mcf=mcf(turned_long),
                dof=dof,
                shape_dof=1.0 / float(shares**2 @ (1.0 / np.array([dof, line_dof, gain_dof]))),
                stability=float(chosen.share[m]),
                drift=drift[m],
                significance=float(chosen.significance[m]),
            )
        )
    return tuple(modes)


def _gain_variance(
    frf: FrequencyResponse,
    values: _Complex,
    misfit: _Complex,
    variance: npt.NDArray[np.float64],
    freq: npt.NDArray[np.float64],
    fit: RankOneFit,
    *,
    transposed: bool,
) -> npt.NDArray[np.float64]:
    """Variance of the factor each point's hits share, of every mode; 0 where no scatter is known.

    Roving hammer: the short side is one sensor, its axes share the hit. Roving response: every
    reference has hits of its own, and a shape is their mean weighted by participation.
    """
    if not np.any((frf.variance > 0.0) & np.isfinite(frf.variance)):
        return np.zeros(fit.poles.size)
    variance = np.where(fit.measured[..., None], variance, 0.0)
    result = np.empty(fit.poles.size)
    least_hz = (SMOOTHED_LINES + 1.0) * float(np.min(np.diff(freq)))
    for m, pole in enumerate(fit.poles):
        # Wider than the scatter was smoothed over: smoothing keeps the sum over the lines.
        reach = max((frf.decay_rad_s - pole.real) / (2.0 * np.pi), least_hz)
        near = np.abs(freq - pole.imag / (2.0 * np.pi)) <= reach
        power = np.abs(fit.participation[:, m]) ** 2
        share = 1.0 if transposed else float(np.sum(power**2) / np.sum(power) ** 2)
        result[m] = share * common_gain_variance(values, misfit, variance, near)
    return result


def _peak_notes(problem: Problem, poles: _Complex) -> list[str]:
    """What stands out and has no mode; FRFs at the mean poles, so that what moves is none."""
    spacing_hz = float(np.median(np.diff(problem.freq_hz)))
    peaks = standing_peaks(problem.freq_hz, problem.values)
    return [
        f"a peak at {peak.f_hz:.5g} Hz, {peak.height:.0f} times as high as its surroundings, is "
        "explained by no mode; fit a band around it, or look whether it is mains or a machine"
        for peak in unexplained(peaks, poles, spacing_hz)
    ]


def _suspension_notes(f_hz: npt.NDArray[np.float64]) -> list[str]:
    """What lies so far below the rest that a soft suspension may be what it bends.

    Ewins, Modal Testing, 2nd ed. (2000), section 3.3: the highest rigid-body mode of a free
    structure lies below a tenth to a fifth of its lowest elastic one. A tenth: the first two modes
    of a clamped beam are a factor of 6.3 apart.
    """
    far = np.flatnonzero(f_hz[:-1] < SUSPENSION * f_hz[1:])
    if far.size == 0:
        return []
    low = f_hz[: int(far[-1]) + 1]
    listed = ", ".join(f"{f:.4g}" for f in low)
    said = (
        f"{listed} Hz: below a tenth of {f_hz[low.size]:.5g} Hz, where a rigid body on its "
        "suspension moves; whether they bend the structure, their shapes tell"
    )
    return [said]


def assemble_model(
    frf: FrequencyResponse,
    lines: FittedLines,
    problem: Problem,
    table: Stabilisation,
    chosen: Kept,
    fit: RankOneFit,
    *,
    drift: tuple[ModeDrift | None, ...],
    spread: npt.NDArray[np.float64],
    transposed: bool,
) -> ModalModel:
    """Record of a fit; `values`, `variance` and `fit` with the longer side first.

    Parameters
    ----------
    frf
        Where the FRFs came from.
    lines, problem
        The lines fitted, and the FRFs as fitted: the longer side first.
    table, chosen, fit
        The poles over orders, the choice, the maximum-likelihood model.
    drift
        Of every mode; the problem's values are then those at the mean poles.
    spread
        (2 n_modes,) of (f, damping) over bands and weights.
    transposed
        True where references were more than responses.
    """
    values, variance, freq = problem.values, problem.variance, problem.freq_hz
    n_freq, line_share = freq.size, problem.line_share
    synthesis = _synthesis(frf, laplace_lines(freq, frf.decay_rad_s), fit, problem.background)
    misfit: _Complex = (values - synthesis) * fit.measured[..., None]
    clusters, names = mountings(frf.references if transposed else frf.responses)
    long_by_short = np.broadcast_to(clusters[:, None], values.shape[:2])
    lack_of_fit = float(fit.cost.sum()) / max(2 * n_freq * fit.n_measured - fit.n_free, 1)
    hits = float(np.median(frf.n_hits[frf.measured]))
    precision = pole_covariance(
        fit,
        clusters,
        lack_of_fit=lack_of_fit,
        share=line_share,
        hit_dof=max(2.0 * (hits - 1.0), 1.0) * float(clusters.max() + 1),
    )
    precision = with_spread(with_drift(precision, drift), spread)
    correlation = axis_correlation(misfit / np.sqrt(variance), clusters)
    modes = _modes(
        fit,
        chosen,
        precision,
        correlation,
        lack_of_fit / line_share,
        derivative_order(frf.form),
        _gain_variance(frf, values, misfit, variance, freq, fit, transposed=transposed),
        clusters,
        drift,
        line_dof=max(2.0 * (hits - 1.0), 1.0) * max(n_freq * line_share, 1.0),
        gain_dof=max(hits - 1.0, 1.0) * float(clusters.max() + 1),
        transposed=transposed,
    )

    def sided(per_frf: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return frozen_array(per_frf.swapaxes(0, 1) if transposed else per_frf, np.float64)

    measured = np.where(fit.measured, 1.0, np.nan)
    left = np.sum(np.abs(misfit) ** 2, axis=-1)
    size = np.sum(np.abs(values) ** 2, axis=-1)
    return ModalModel(
        posture=frf.posture,
        form=frf.form,
        band_hz=lines.band_hz,
        modes=modes,
        background_rad_s=frozen_array(problem.background, np.complex128),
        residual_terms=sided(_residuals(frf, fit)),
        covariance=frozen_array(precision.covariance, np.float64),
        robust_covariance=precision.robust,
        synthesis_error=float(np.sqrt(left.sum() / size.sum())),
        frf_error=sided(measured * np.sqrt(left / np.maximum(size, np.finfo(float).tiny))),
        frac=sided(measured * frac(values, synthesis)),
        lack_of_fit=2.0 * lack_of_fit,
        responses=frf.responses,
        references=frf.references,
        joints_rad=frf.joints_rad,
        stabilisation=table,
        mountings=names,
        mounting=frozen_array(long_by_short.T if transposed else long_by_short, np.int64),
        notes=(
            *lines.notes,
            *_peak_notes(problem, fit.poles),
            *background_note(problem.background),
            *_suspension_notes(np.sort(np.abs(fit.poles)) / (2.0 * np.pi)),
        ),
    )
