"""From an FRF matrix to modes with uncertainty, without a starting guess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.assemble import assemble_model
from armodal.analyzer.modal.choice import candidate_poles, merge_duplicates, zoom_bands
from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.modes import ModalModel
from armodal.analyzer.modal.noise import independent_line_share
from armodal.analyzer.modal.plscf import Stabilisation, poles_plscf
from armodal.analyzer.modal.rank_one import refine_rank_one
from armodal.analyzer.modal.regression import ModalData, modal_data
from armodal.analyzer.modal.second_look import left_over_poles, split_poles
from armodal.analyzer.modal.selection import Selection, keep_modes, select_modes
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["fit_modes", "fit_modes_at"]

_FEWEST_LINES = 8
_MOST_ROUNDS = 8  # of looking for poles in what the model leaves over
_LEAST_PROGRESS = 0.99  # of the misfit before the round
_ZOOM_ORDER_STEP = 3  # orders of a zoomed band: some fifteen suffice, each is an eigenvalue problem


def _check(frf: FrequencyResponse) -> None:
    """Refuse FRFs nothing can be fitted to, with the reason."""
    where = f"FRFs of posture {frf.posture!r}"
    derivative_order(frf.form)
    wanted = (len(frf.responses), len(frf.references), frf.freq_hz.size)
    if frf.values.shape != wanted or frf.variance.shape != wanted:
        raise EstimateError(
            f"{where}: wanted values and variance of shape {wanted}, got {frf.values.shape} and "
            f"{frf.variance.shape}; rebuild the FRFs"
        )
    if min(wanted[:2]) == 0:
        raise EstimateError(f"{where}: there are none; wanted a response and a reference at least")
    bad = ~np.isfinite(frf.values).all(axis=-1)
    if np.any(bad):
        i, j = np.argwhere(bad)[0]
        raise EstimateError(
            f"{where}: {np.count_nonzero(bad)} of {bad.size} FRFs hold values that are not "
            f"finite, the first at response {frf.responses[i].point} {frf.responses[i].label}, "
            f"reference {frf.references[j].point}; leave those FRFs out"
        )
    if wanted[2] < _FEWEST_LINES:
        raise EstimateError(
            f"{where}: a fit needs at least {_FEWEST_LINES} lines, got {wanted[2]}; record longer"
        )
    f = frf.freq_hz
    if not np.all(np.isfinite(f)) or np.any(np.diff(f) <= 0.0) or f[0] <= 0.0:
        raise EstimateError(
            f"{where}: frequencies must be finite, increase, and be above 0 Hz; "
            "sort the lines, drop 0 Hz"
        )
    if np.any(frf.coherence > 1.0 + 1e-6):
        raise EstimateError(
            f"{where}: coherence reaches {np.nanmax(frf.coherence):.3g}, it cannot exceed 1; "
            "rebuild it from the hits"
        )
    if not np.any(frf.values):
        raise EstimateError(f"{where}: all values are zero; check the response channels")


def _band(frf: FrequencyResponse, band_hz: tuple[float, float] | None) -> npt.NDArray[np.bool_]:
    if band_hz is None:
        keep = np.ones(frf.freq_hz.size, dtype=bool)
    else:
        keep = (frf.freq_hz >= band_hz[0]) & (frf.freq_hz <= band_hz[1])
    if np.count_nonzero(keep) < _FEWEST_LINES:
        raise EstimateError(
            f"posture {frf.posture!r}: a fit needs at least {_FEWEST_LINES} lines, the band holds "
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
    shared = np.maximum(mean_square, 1e-12 * largest)
    if not np.any(known):
        return np.broadcast_to(shared, values.shape)
    # Below 1e-12 of the mean square a variance is rounding, and no longer a weight.
    least = np.maximum(1e-12 * mean_square, 1e-20 * largest)
    filled: npt.NDArray[np.float64] = np.where(known, np.maximum(given, least), shared)
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
            order_step=_ZOOM_ORDER_STEP,
        )
        found, share = candidate_poles(table, (low, high))
        poles.append(found)
        shares.append(share)
    pole, share = np.concatenate(poles), np.concatenate(shares)
    kept = merge_duplicates(pole, share)
    return whole, pole[kept], share[kept]


def _looked_again(
    data: ModalData,
    chosen: Selection,
    freq: npt.NDArray[np.float64],
    n_ref: int,
    decay: float,
    line_share: float,
) -> Selection:
    """Choose again with the poles that the misfit holds, until it holds none that are needed."""
    band = (float(freq[0]), float(freq[-1]))
    for _ in range(_MOST_ROUNDS):
        found, seen = left_over_poles(
            data, chosen.fit, freq, n_ref, decay_rad_s=decay, line_share=line_share
        )
        poles = np.concatenate([chosen.fit.poles, found])
        # Those already chosen come before any that are found beside them.
        rank = np.concatenate([np.full(chosen.share.size, 2.0), seen])
        kept = merge_duplicates(poles, rank)
        if kept.size <= chosen.share.size:
            break
        share = np.concatenate([chosen.share, seen])[kept]
        again = select_modes(data, poles[kept], share, band, line_share=line_share, chosen=chosen)
        if again.fit.cost.sum() > _LEAST_PROGRESS * chosen.fit.cost.sum():
            break
        chosen = again
    return _split(data, chosen, freq, line_share)


def _split(
    data: ModalData, chosen: Selection, freq: npt.NDArray[np.float64], line_share: float
) -> Selection:
    """Choose again with a second pole beside each mode that leaves a misfit, where needed."""
    band = (float(freq[0]), float(freq[-1]))
    for pole in split_poles(data, chosen.fit, freq, line_share=line_share):
        again = select_modes(
            data,
            np.append(chosen.fit.poles, pole),
            np.append(chosen.share, 0.0),
            band,
            line_share=line_share,
            chosen=chosen,
        )
        if again.share.size > chosen.share.size:
            chosen = again
    return chosen


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
        chosen = select_modes(data, poles, stability, lines.band_hz, line_share=lines.share)
        n_ref = min(lines.values.shape[:2])
        return _looked_again(data, chosen, lines.freq_hz, n_ref, frf.decay_rad_s, lines.share)

    return _fitted(frf, lines, table, select)


def fit_modes_at(
    frf: FrequencyResponse,
    poles_rad_s: npt.ArrayLike,
    stabilisation: Stabilisation,
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

    Raises
    ------
    EstimateError
        If a pole is unstable or outside the band, or the FRFs cannot be fitted.
    """
    lines = _fitted_lines(frf, None)
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
    values, variance = lines.values, lines.variance
    transposed = values.shape[1] > values.shape[0]
    if transposed:  # by reciprocity the short side serves as references
        values, variance = values.transpose(1, 0, 2), variance.transpose(1, 0, 2)
    try:
        data = modal_data(frf.form, laplace_lines(lines.freq_hz, frf.decay_rad_s), values, variance)
        chosen = choose(data)
        start = chosen.fit.residues.reshape(*values.shape[:2], -1)
        fit = refine_rank_one(data, chosen.fit.poles, start)
    except np.linalg.LinAlgError as error:
        raise EstimateError(
            f"posture {frf.posture!r}: the modal fit met a singular matrix ({error}); "
            "check for constant or repeated FRFs, or narrow the band",
            partial=table,
        ) from error
    return assemble_model(
        frf,
        lines.band_hz,
        values,
        variance,
        table,
        chosen,
        fit,
        line_share=lines.share,
        transposed=transposed,
    )
