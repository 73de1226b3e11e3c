"""The band to fit where nobody asked for one: all between the lines that carry a signal.

Beyond what the hammer excites, and where coherence is lost, an FRF is noise over next to no force.
A line carries a signal where, averaged over all FRFs and some neighbours, at least as much of the
power is signal as is noise. The noise is the variance told; where none is told, it is what the
second difference over lines leaves, of which noise alone has six times its power and what is
smooth next to nothing.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.noise import SMOOTHED_LINES, smooth_lines
from armodal.analyzer.modal.peaks import standing_peaks
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["carried_band"]

CARRIED = 2.0  # power over that of noise: at least half is signal


def carried_band(frf: FrequencyResponse) -> tuple[float, float] | None:
    """Lowest and highest frequency that carry a signal; None where all lines do, or none.

    Parameters
    ----------
    frf
        FRFs of any form.
    """
    values = frf.values[frf.measured]
    variance = frf.variance[frf.measured]
    few = frf.freq_hz.size <= 4 * SMOOTHED_LINES
    if few or not values.any() or not np.isfinite(values).all():  # the fit says what is wrong
        return None
    told = bool(np.all(np.isfinite(variance) & (variance > 0.0)))
    noise = variance if told else _rough(values)
    power = smooth_lines(np.abs(values) ** 2, SMOOTHED_LINES)
    noise = smooth_lines(noise, SMOOTHED_LINES)
    ratio = np.mean(power / np.maximum(noise, np.finfo(float).tiny * 1e8), axis=0)
    carries = ratio > CARRIED
    for peak in standing_peaks(frf.freq_hz, frf.values):
        carries |= np.abs(frf.freq_hz - peak.f_hz) <= peak.half_width_hz
    lines = np.flatnonzero(carries)
    # What the average over neighbours blurs is no end.
    if not lines.size or (
        lines[0] <= SMOOTHED_LINES and lines[-1] >= carries.size - 1 - SMOOTHED_LINES
    ):
        return None
    first = 0 if lines[0] <= SMOOTHED_LINES else lines[0]
    last = carries.size - 1 if lines[-1] >= carries.size - 1 - SMOOTHED_LINES else lines[-1]
    return float(frf.freq_hz[first]), float(frf.freq_hz[last])


def _rough(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Power of noise on each line by second differences: (n_frf, n_freq)."""
    inner = np.abs(values[:, :-2] - 2.0 * values[:, 1:-1] + values[:, 2:]) ** 2 / 6.0
    return np.pad(inner, ((0, 0), (1, 1)), mode="edge")
