"""From an FRF matrix to modes with uncertainty, without a starting guess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from analyzer.modal.choice import (
    candidate_poles,
    merge_duplicates,
    zoom_bands,
)
from analyzer.modal.correlation import mpc, mpd_deg, to_real_axis
from analyzer.modal.modes import ModalModel, Mode, response_points, synthesise
from analyzer.modal.noise import independent_line_share
from analyzer.modal.plscf import Stabilisation, poles_plscf
from analyzer.modal.regression import ModalData, modal_data
from analyzer.modal.selection import Selection, keep_modes, lack_of_fit, select_modes
from analyzer.modal.uncertainty import PoleCovariance, pole_covariance
from analyzer.modal.windows import laplace_lines
from protocols.arrays import frozen_array
from protocols.errors import EstimateError
from protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["fit_modes", "fit_modes_at"]

_POWER = {FrfForm.RECEPTANCE: 0, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 2}


def _check(frf: FrequencyResponse) -> None:
    """Refuse FRFs nothing can be fitted to, with the reason."""
    where = f"FRFs of posture {frf.posture!r}"
    wanted = (len(frf.responses), len(frf.references), frf.freq_hz.size)
    if frf.values.shape != wanted or frf.variance.shape != wanted:
        raise EstimateError(
            f"{where}: wanted values and variance of shape {wanted}, got {frf.values.shape} and "
            f"{frf.variance.shape}; rebuild the FRFs"
        )
    if not np.all(np.isfinite(frf.values)):
        count = int(np.count_nonzero(~np.isfinite(frf.values)))
        raise EstimateError(f"{where}: {count} values are not finite; leave those FRFs out")
    if np.any(np.diff(frf.freq_hz) <= 0.0) or np.any(frf.freq_hz <= 0.0):
        raise EstimateError(
            f"{where}: frequencies must increase and be above 0 Hz; sort the lines, drop 0 Hz"
        )
    if np.any(frf.coherence > 1.0 + 1e-6):
        raise EstimateError(
            f"{where}: coherence reaches {frf.coherence.max():.3g}, it cannot exceed 1; "
            "rebuild it from the hits"
        )
    if not np.any(frf.values):
        raise EstimateError(f"{where}: all values are zero; check the response channels")


def _band(frf: FrequencyResponse, band_hz: tuple[float, float] | None) -> npt.NDArray[np.bool_]:
    if band_hz is None:
        keep = np.ones(frf.freq_hz.size, dtype=bool)
    else:
        keep = (frf.freq_hz >= band_hz[0]) & (frf.freq_hz <= band_hz[1])
    if np.count_nonzero(keep) < 8:
        raise EstimateError(
            f"posture {frf.posture!r}: a fit needs at least 8 lines, the band holds "
            f"{np.count_nonzero(keep)} of {frf.freq_hz.size}; widen it or record longer"
        )
    return keep


def _variance(
    values: npt.NDArray[np.complex128], given: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Line variances, never zero: (n_resp, n_ref, n_freq).

    FRFs without a stated variance share one in proportion to their mean square.
    """
    mean_square = np.mean(np.abs(values) ** 2, axis=-1, keepdims=True)
    largest = float(mean_square.max())
    known = np.isfinite(given) & (given > 0.0)
    if not np.any(known):
        return np.broadcast_to(np.maximum(mean_square, 1e-12 * largest), values.shape)
    # Below 1e-12 of the mean square a variance is rounding, and no longer a weight.
    least = np.maximum(1e-12 * mean_square, 1e-20 * largest)
    filled: npt.NDArray[np.float64] = np.where(known, np.maximum(given, least), mean_square)
    return filled


def _candidates(
    values: npt.NDArray[np.complex128],
    variance: npt.NDArray[np.float64],
    freq: npt.NDArray[np.float64],
    decay: float,
    max_order: int,
) -> tuple[Stabilisation, npt.NDArray[np.complex128], npt.NDArray[np.float64]]:
    """Stabilisation of the whole band, and candidates from it and from the zoomed bands.

    The short side of the matrix serves as references, by reciprocity.
    """
    if values.shape[1] > values.shape[0]:
        values, variance = values.transpose(1, 0, 2), variance.transpose(1, 0, 2)
    weight = 1.0 / np.sqrt(variance.mean(axis=1))
    whole = poles_plscf(values, freq, decay_rad_s=decay, weight=weight, max_order=max_order)
    found, share = candidate_poles(whole, (float(freq[0]), float(freq[-1])))
    poles, shares = [found], [share]
    # A polynomial matrix of n_ref columns has n_ref times as many poles as its order.
    zoom_order = max(max_order // values.shape[1], 8)
    for low, high in zoom_bands(freq):
        lines = (freq >= low) & (freq <= high)
        table = poles_plscf(
            values[..., lines],
            freq[lines],
            decay_rad_s=decay,
            weight=weight[:, lines],
            max_order=min(zoom_order, int(np.count_nonzero(lines)) // 2),
        )
        found, share = candidate_poles(table, (low, high))
        poles.append(found)
        shares.append(share)
    pole, share = np.concatenate(poles), np.concatenate(shares)
    kept = merge_duplicates(pole, share)
    return whole, pole[kept], share[kept]


def fit_modes(
    frf: FrequencyResponse,
    *,
    band_hz: tuple[float, float] | None = None,
    max_order: int = 60,
) -> ModalModel:
    """Poles, shapes and residual terms of one FRF matrix.

    Poles over model orders by pLSCF, candidates where they gather, choice by what the data need,
    then a weighted least-squares fit of the whole model to the FRFs.

    Parameters
    ----------
    frf
        FRFs of any form, weighted by their variance.
    band_hz
        Lines used, and where modes may lie; all lines by default.
    max_order
        Highest order of the stabilisation.

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
    lines = _fitted_lines(frf, band_hz)
    table, poles, stability = _candidates(
        lines.values, lines.variance, lines.freq_hz, frf.decay_rad_s, max_order
    )

    def select(data: ModalData) -> Selection:
        return select_modes(data, poles, stability, lines.band_hz, line_share=lines.share)

    return _fitted(frf, lines, table, select)


def fit_modes_at(
    frf: FrequencyResponse,
    poles_rad_s: npt.ArrayLike,
    stabilisation: Stabilisation,
    *,
    band_hz: tuple[float, float] | None = None,
) -> ModalModel:
    """Shapes, refined poles and residual terms from poles picked by hand.

    Every pole given is kept and refined to the least weighted misfit; none is added.

    Parameters
    ----------
    frf
        FRFs of any form, weighted by their variance.
    poles_rad_s
        (n,) starting poles, imaginary parts above zero.
    stabilisation
        The poles over model orders they were picked from; carried into the result.
    band_hz
        Lines used; all by default.

    Raises
    ------
    EstimateError
        If a pole is unstable or outside the band, or the FRFs cannot be fitted.
    """
    lines = _fitted_lines(frf, band_hz)
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

    def keep(data: ModalData) -> Selection:
        return keep_modes(data, poles, seen, line_share=lines.share)

    return _fitted(frf, lines, stabilisation, keep)


def _share_of_orders(table: Stabilisation, pole: complex) -> float:
    """Share of the model orders with a pole within 1 % of this one."""
    near = np.abs(table.pole_rad_s - pole) <= 0.01 * abs(pole)
    return len(np.unique(table.order[near])) / max(len(table.orders), 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Lines:
    """What is fitted: the lines of the band."""

    freq_hz: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    variance: npt.NDArray[np.float64]
    share: float  # independent lines per line

    @property
    def band_hz(self) -> tuple[float, float]:
        return float(self.freq_hz[0]), float(self.freq_hz[-1])


def _fitted_lines(frf: FrequencyResponse, band_hz: tuple[float, float] | None) -> _Lines:
    _check(frf)
    keep = _band(frf, band_hz)
    freq = frf.freq_hz[keep]
    values = np.ascontiguousarray(frf.values[..., keep])
    return _Lines(
        freq_hz=freq,
        values=values,
        variance=_variance(values, frf.variance[..., keep]),
        share=independent_line_share(frf.decay_rad_s, float(np.min(np.diff(freq)))),
    )


def _fitted(
    frf: FrequencyResponse,
    lines: _Lines,
    table: Stabilisation,
    choose: Callable[[ModalData], Selection],
) -> ModalModel:
    try:
        data = modal_data(
            frf.form, laplace_lines(lines.freq_hz, frf.decay_rad_s), lines.values, lines.variance
        )
        chosen = choose(data)
        clusters = response_points(frf).reshape(-1)
        hits = float(np.median(frf.n_hits))
        precision = pole_covariance(
            chosen.fit,
            clusters,
            n_freq=lines.freq_hz.size,
            share=lines.share,
            hit_dof=max(2.0 * (hits - 1.0), 1.0) * float(clusters.max() + 1),
        )
    except np.linalg.LinAlgError as error:
        raise EstimateError(
            f"posture {frf.posture!r}: the modal fit met a singular matrix ({error}); "
            "check for constant or repeated FRFs, or narrow the band",
            partial=table,
        ) from error
    return _model(frf, lines.freq_hz, lines.values, table, chosen, precision)


def _model(
    frf: FrequencyResponse,
    freq: npt.NDArray[np.float64],
    values: npt.NDArray[np.complex128],
    table: Stabilisation,
    chosen: Selection,
    precision: PoleCovariance,
) -> ModalModel:
    fit = chosen.fit
    n_resp, n_ref, n_freq = values.shape
    std = np.sqrt(np.maximum(np.diag(precision.covariance), 0.0))
    modes = tuple(
        _mode(
            complex(pole),
            fit.residues[:, m].reshape(n_resp, n_ref) / pole ** _POWER[frf.form],
            std[2 * m : 2 * m + 2],
            float(precision.dof[2 * m : 2 * m + 2].min()),
            float(chosen.share[m]),
            float(chosen.significance[m]),
        )
        for m, pole in enumerate(fit.poles)
    )
    model = ModalModel(
        posture=frf.posture,
        form=frf.form,
        band_hz=(float(freq[0]), float(freq[-1])),
        modes=modes,
        residual_terms=frozen_array(fit.residuals.reshape(n_resp, n_ref, -1), np.float64),
        covariance=frozen_array(precision.covariance, np.float64),
        robust_covariance=precision.robust,
        synthesis_error=0.0,
        frf_error=frozen_array(np.zeros((n_resp, n_ref)), np.float64),
        lack_of_fit=2.0 * lack_of_fit(fit, n_freq),
        responses=frf.responses,
        references=frf.references,
        joints_rad=frf.joints_rad,
        stabilisation=table,
    )
    misfit = np.abs(synthesise(model, freq, decay_rad_s=frf.decay_rad_s) - values) ** 2
    size = np.abs(values) ** 2
    per_frf = np.sqrt(misfit.sum(axis=-1) / np.maximum(size.sum(axis=-1), np.finfo(float).tiny))
    return replace(
        model,
        synthesis_error=float(np.sqrt(misfit.sum() / size.sum())),
        frf_error=frozen_array(per_frf, np.float64),
    )


def _mode(
    pole: complex,
    residues: npt.NDArray[np.complex128],
    std: npt.NDArray[np.float64],
    dof: float,
    stability: float,
    significance: float,
) -> Mode:
    """Split receptance residues (n_resp, n_ref) into shape and participation (rank one)."""
    U, S, Vh = np.linalg.svd(residues, full_matrices=False)
    turned = to_real_axis(U[:, 0])
    shape = turned / np.max(np.abs(turned))
    participation = S[0] * Vh[0] * (np.vdot(shape, U[:, 0]) / np.vdot(shape, shape))
    # Complexity is told on the side that has the points.
    points = shape if shape.size >= participation.size else participation
    return Mode(
        pole_rad_s=pole,
        f_hz=abs(pole) / (2.0 * np.pi),
        f_std_hz=float(std[0]),
        damping_ratio=-pole.real / abs(pole),
        damping_std=float(std[1]),
        shape=frozen_array(shape, np.complex128),
        participation=frozen_array(participation, np.complex128),
        mpc=mpc(points),
        mpd_deg=mpd_deg(points),
        dof=dof,
        stability=stability,
        significance=significance,
    )
