"""Where the misfit of a modal model looks like a mode that it lacks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.modes import ModalModel, synthesise
from armodal.analyzer.modal.noise import independent_line_share
from armodal.analyzer.modal.peaks import NEAR_LINES
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["MissingModeHint", "missing_mode_hints"]

_DAMPING = 0.02  # of the resonance looked for: sets the width, three half bandwidths either side
_LEAST_LINES = 3
_LEAST_Z = 6.0  # standard deviations of the noise's own scatter
_LEAST_RATIO = 1.5
_LEAST_SHARE = 1e-5  # RMS of the FRFs: six printed digits leave up to 5e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingModeHint:
    """A place where the misfit stands out."""

    f_hz: float
    ratio: float  # weighted misfit there over its median along the band
    share: float  # RMS misfit over RMS of the FRFs there
    # A mode of the model within its bandwidth, or within what lines tell: it fits worse than most.
    beside_hz: float | None


def missing_mode_hints(frf: FrequencyResponse, model: ModalModel) -> tuple[MissingModeHint, ...]:
    """Frequencies at which a mode seems to be missing, most conspicuous first.

    The misfit over its standard deviation, squared, is averaged over all FRFs and over lines one
    bandwidth wide. A hint is given where that exceeds 1.5 times its median, and its median by six
    times the scatter that noise would give it, and where it is more than rounding of the numbers.
    Within a bandwidth of the band's edges none is given: there no peak can be told from the slope
    of what lies outside.

    Parameters
    ----------
    frf
        The FRFs fitted, of the same form as the model.
    model
        The model.

    Raises
    ------
    EstimateError
        If form or size of FRFs and model differ.
    """
    wanted = (len(model.responses), len(model.references))
    if frf.form is not model.form or frf.values.shape[:2] != wanted:
        raise EstimateError(
            f"hints need FRFs as the model was fitted to: {model.form} of shape {wanted}, got "
            f"{frf.form} of shape {frf.values.shape[:2]}; convert the form"
        )
    keep = (frf.freq_hz >= model.band_hz[0]) & (frf.freq_hz <= model.band_hz[1])
    freq, values = frf.freq_hz[keep], frf.values[..., keep]
    misfit = np.abs(values - synthesise(model, freq, decay_rad_s=frf.decay_rad_s)) ** 2
    variance = frf.variance[..., keep]
    if not np.all(variance > 0.0):
        variance = np.maximum(np.median(misfit, axis=-1, keepdims=True), np.finfo(float).tiny)
    told = frf.measured[..., None]
    power = np.mean(misfit / variance, axis=(0, 1), where=told)
    size = np.mean(np.abs(values) ** 2 / variance, axis=(0, 1), where=told)

    reach = np.maximum(3.0 * _DAMPING * freq, 0.5 * _LEAST_LINES * np.median(np.diff(freq)))
    low = np.searchsorted(freq, freq - reach)
    high = np.searchsorted(freq, freq + reach, side="right")

    def smoothed(lines: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        total = np.concatenate([[0.0], np.cumsum(lines)])
        mean: npt.NDArray[np.float64] = (total[high] - total[low]) / (high - low)
        return mean

    level = smoothed(power)
    usual = float(np.median(level))
    if usual <= 0.0:
        return ()
    share = independent_line_share(frf.decay_rad_s, float(np.min(np.diff(freq))))
    scatter = 1.0 / np.sqrt(np.count_nonzero(told) * (high - low) * share)
    ratio = level / usual
    stands_out = ratio > np.maximum(_LEAST_RATIO, 1.0 + _LEAST_Z * scatter)
    hints = []
    while np.any(stands_out):
        k = int(np.argmax(np.where(stands_out, ratio, 0.0)))
        own = slice(int(low[k]), int(high[k]))
        peak = int(low[k]) + int(np.argmax(power[own]))
        at_edge = peak < high[0] or peak >= low[-1]
        beside = _beside(model, float(freq[peak]), float(np.median(np.diff(freq))))
        left = float(np.sqrt(power[own].sum() / max(size[own].sum(), 1e-300)))
        # What rises towards an edge is a mode outside the band, if any.
        if not at_edge and left >= _LEAST_SHARE:
            hints.append(
                MissingModeHint(
                    f_hz=float(freq[peak]),
                    ratio=float(ratio[k]),
                    share=left,
                    beside_hz=beside,
                )
            )
        # One hint covers the slopes on either side down to where the misfit is usual again.
        first, last = k, k
        while first > 0 and ratio[first - 1] > 1.0:
            first -= 1
        while last < freq.size - 1 and ratio[last + 1] > 1.0:
            last += 1
        stands_out[first : last + 1] = False
    return tuple(hints)


def _beside(model: ModalModel, f_hz: float, spacing_hz: float) -> float | None:
    """The mode nearest to a frequency, if that lies on its peak.

    A resonance narrower than the lines' spacing leaves its misfit a line beside it.
    """
    near = min(model.modes, key=lambda mode: abs(mode.f_hz - f_hz), default=None)
    if near is None:
        return None
    reach = max(near.damping_ratio * near.f_hz, NEAR_LINES * spacing_hz)
    return near.f_hz if abs(near.f_hz - f_hz) <= reach else None
