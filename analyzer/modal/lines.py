"""Which lines of FRFs are fitted, and with what variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.band import FEWEST_LINES, lines_within
from armodal.analyzer.modal.complete_parts import linked
from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.near_zero import first_line
from armodal.analyzer.modal.noise import (
    hit_scatter_variance,
    independent_line_share,
)
from armodal.analyzer.modal.running_median import running_median
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["FittedLines", "fitted_lines", "misfit_variance"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]

MEDIAN_LINES = 41  # of a running median: more than twice as many as the sharpest resonance roughens


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedLines:
    """What is fitted: the lines of the band."""

    freq_hz: _Real
    values: _Complex  # (n_resp, n_ref, n_freq)
    variance: _Real  # (n_resp, n_ref, n_freq), above 0; infinite where not measured
    told: bool  # the variance came with the FRFs
    share: float  # independent lines per line
    notes: tuple[str, ...]

    @property
    def band_hz(self) -> tuple[float, float]:
        """Lowest and highest line."""
        return float(self.freq_hz[0]), float(self.freq_hz[-1])


def fitted_lines(frf: FrequencyResponse, band_hz: tuple[float, float] | None) -> FittedLines:
    """Lines of the band that carry a measurement, with their variance.

    Parameters
    ----------
    frf
        FRFs of any form.
    band_hz
        The band; None for all lines.

    Raises
    ------
    EstimateError
        If nothing can be fitted to them, with the reason.
    """
    _check(frf)
    notes = _beyond(frf, band_hz)
    if band_hz is not None:
        frf = lines_within(frf, band_hz)
    holes = np.count_nonzero(~frf.measured)
    if holes:
        said = f"{holes} of {frf.measured.size} FRFs were not measured and are left out"
        notes = (*notes, said)
    given = frf.variance
    told = bool(np.any(np.isfinite(given) & (given > 0.0)))
    first, why = first_line(frf, told=told)
    if first:
        notes = (*notes, f"lines below {frf.freq_hz[first]:.4g} Hz are left out: {why}")
    values = np.where(frf.measured[..., None], frf.values[..., first:], 0.0)
    freq = frf.freq_hz[first:]
    return FittedLines(
        freq_hz=freq,
        values=values,
        variance=_given_variance(values, given[..., first:], frf.measured),
        told=told,
        share=independent_line_share(frf.decay_rad_s, float(np.min(np.diff(freq)))),
        notes=notes,
    )


def _beyond(frf: FrequencyResponse, band_hz: tuple[float, float] | None) -> tuple[str, ...]:
    """Say where FRFs have no lines that were asked for."""
    if band_hz is None:
        return ()
    first, last = float(frf.freq_hz[0]), float(frf.freq_hz[-1])
    spacing = float(np.median(np.diff(frf.freq_hz)))
    if band_hz[0] > first - spacing and band_hz[1] < last + spacing:
        return ()
    asked = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz was asked for"
    return (f"{asked}, the FRFs hold {first:.4g} to {last:.5g} Hz",)


def misfit_variance(
    left: _Complex, values: _Complex, line_share: float, measured: npt.NDArray[np.bool_]
) -> _Real:
    """Variance of each line from what a model leaves of the FRFs.

    A noise floor that varies slowly over the lines, and an error in proportion to the FRF, as a
    resonance that bends or leaks makes it, are told apart as for hits (`hit_scatter_variance`),
    on the mean over all FRFs, each in units of its own floor. About a narrow peak it is too large
    rather than too small.

    Parameters
    ----------
    left, values
        (n_resp, n_ref, n_freq), the misfit and the FRFs.
    line_share
        Independent lines per line under the window.
    measured
        (n_resp, n_ref); the variance of others is infinite.
    """
    power, size = np.abs(left[measured]) ** 2, np.abs(values[measured]) ** 2
    own = np.median(power, axis=-1, keepdims=True) / np.log(2.0)
    largest = np.mean(size, axis=-1, keepdims=True)
    own = np.maximum(own, np.maximum(1e-12 * largest, 1e-20 * float(largest.max())))
    mean, mean_size = ((x / own).mean(axis=0)[None, None] for x in (power, size))
    width = min(MEDIAN_LINES, mean.shape[-1])
    # The mean of k squared magnitudes has its median at its mean but for a third of 1 / k.
    n_frf = power.shape[0]
    floor = running_median(mean, width) / (1.0 - 1.0 / (3.0 * n_frf))
    shape = hit_scatter_variance(
        mean, np.maximum(floor, 1e-12), mean_size, np.array([[1 + n_frf]]), line_share
    )
    result: _Real = np.full(values.shape, np.inf)
    result[measured] = own * shape[0]
    return result


def _given_variance(values: _Complex, given: _Real, measured: npt.NDArray[np.bool_]) -> _Real:
    """Line variances, never zero; FRFs without one share one by their mean square."""
    mean_square = np.mean(np.abs(values) ** 2, axis=-1, keepdims=True)
    largest = float(mean_square.max())
    known = np.isfinite(given) & (given > 0.0)
    shared = np.maximum(mean_square, 1e-12 * largest)
    # Below 1e-12 of the mean square a variance is rounding, and no longer a weight.
    least = np.maximum(1e-12 * mean_square, 1e-20 * largest)
    filled: _Real = np.where(known, np.maximum(given, least), shared)
    filled[~measured] = np.inf
    return filled


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
    if wanted[2] < FEWEST_LINES:
        raise EstimateError(
            f"{where}: a fit needs at least {FEWEST_LINES} lines, got {wanted[2]}; record longer"
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
    _check_measured(frf, where)
    if not np.any(frf.values):
        raise EstimateError(f"{where}: all values are zero; check the response channels")


def _check_measured(frf: FrequencyResponse, where: str) -> None:
    """Refuse FRFs with holes that leave a response, a reference or a link between them untold."""
    measured = frf.measured
    for dofs, told in ((frf.responses, measured.any(1)), (frf.references, measured.any(0))):
        for dof in (dofs[i] for i in np.flatnonzero(~told)):
            raise EstimateError(
                f"{where}: no FRF of {dof.point} {dof.label} was measured; leave it out"
            )
    apart = ~linked(measured)
    if apart.any():
        first, other = frf.responses[0], frf.responses[int(np.argmax(apart))]
        raise EstimateError(
            f"{where}: wanted responses that share references; {other.point} {other.label} and "
            f"{first.point} {first.label} have none in common, nor by way of others, so one "
            "shape over both has no size; measure an FRF that links them, or fit them as "
            "postures of their own"
        )
