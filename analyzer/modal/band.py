"""The band to fit where nobody asked for one: all between the lines that carry a signal.

Beyond what the hammer excites, and where coherence is lost, an FRF is noise over next to no force.
A line carries a signal where, averaged over all FRFs and some neighbours, at least as much of the
power is signal as is noise. The noise is the variance told; where none is told, it is what the
second difference over lines leaves, of which noise alone has six times its power and what is
smooth next to nothing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.modal.noise import SMOOTHED_LINES, rough_level, smooth_lines
from armodal.analyzer.modal.peaks import standing_peaks
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["FEWEST_LINES", "carried_band", "lines_within", "proposed_band"]

FEWEST_LINES = 8  # of a fit: real and imaginary parts of a mode, of what lies beside it, and some

MARGIN_LINES = 4 * SMOOTHED_LINES  # the flank of a mode that ends a band is part of it
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
    few = frf.freq_hz.size <= 2 * MARGIN_LINES
    if few or not values.any() or not np.isfinite(values).all():
        return None  # the fit says what is wrong
    told = bool(np.all(np.isfinite(variance) & (variance > 0.0)))
    noise = variance if told else rough_level(values) / 6.0
    power = smooth_lines(np.abs(values) ** 2, SMOOTHED_LINES)
    noise = smooth_lines(noise, SMOOTHED_LINES)
    ratio = np.mean(power / np.maximum(noise, np.finfo(float).tiny * 1e8), axis=0)
    carries = ratio > CARRIED
    for peak in standing_peaks(frf.freq_hz, frf.values):
        carries |= np.abs(frf.freq_hz - peak.f_hz) <= peak.half_width_hz
    lines = np.flatnonzero(carries)
    if not lines.size:
        return None
    first, last = max(lines[0] - MARGIN_LINES, 0), min(lines[-1] + MARGIN_LINES, carries.size - 1)
    if first == 0 and last == carries.size - 1:
        return None
    return float(frf.freq_hz[first]), float(frf.freq_hz[last])


def proposed_band(frf: FrequencyResponse) -> tuple[tuple[float, float] | None, tuple[str, ...]]:
    """The band to fit where nobody asked for one, and a sentence on what is left out.

    Returns
    -------
    tuple
        None and no sentence where all lines carry a signal, or none does.
    """
    band = carried_band(frf)
    if band is None:
        return None, ()
    ends = [f"below {band[0]:.4g}"] if band[0] > frf.freq_hz[0] else []
    ends += [f"above {band[1]:.5g}"] if band[1] < frf.freq_hz[-1] else []
    said = (
        f"posture {frf.posture!r}: no band was asked for: lines {' and '.join(ends)} Hz are noise "
        "and left out; `--band` takes others"
    )
    return band, (said,)


def lines_within(frf: FrequencyResponse, band_hz: tuple[float, float]) -> FrequencyResponse:
    """FRFs on the lines of a band only.

    Raises
    ------
    EstimateError
        If the band holds too few lines to fit anything to.
    """
    keep = (frf.freq_hz >= band_hz[0]) & (frf.freq_hz <= band_hz[1])
    if np.count_nonzero(keep) < FEWEST_LINES:
        raise EstimateError(
            f"posture {frf.posture!r}: a fit needs at least {FEWEST_LINES} lines, the band "
            f"{band_hz[0]:g} to {band_hz[1]:g} Hz holds {np.count_nonzero(keep)} of "
            f"{frf.freq_hz.size} from {frf.freq_hz[0]:.4g} to {frf.freq_hz[-1]:.5g} Hz; widen it "
            "or record longer"
        )
    return replace(
        frf,
        freq_hz=frozen_array(frf.freq_hz[keep], np.float64),
        values=frozen_array(frf.values[..., keep], np.complex128),
        variance=frozen_array(frf.variance[..., keep], np.float64),
        coherence=frozen_array(frf.coherence[..., keep], np.float64),
    )
