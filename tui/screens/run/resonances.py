"""Peaks of one point's FRFs, for the operator's eye: a fit takes longer than a hit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["Resonance", "resonances"]

PROMINENCE_DB = 6.0  # over the saddles: twice in amplitude
CLEAR_STD = 5.0  # some 250 lines are looked at: noise passes this in one FRF of 10^4


@dataclass(frozen=True, slots=True, kw_only=True)
class Resonance:
    """A peak of the axes' summed power."""

    f_hz: float
    half_width_hz: float  # where the power has fallen to half
    line: int


def resonances(frf: FrequencyResponse) -> tuple[Resonance, ...]:
    """Return the peaks of one reference's FRFs that stand out of noise, by frequency.

    Parameters
    ----------
    frf
        Of one point, any form; the first reference is looked at.
    """
    power = np.sum(np.abs(frf.values[:, 0]) ** 2, axis=0)
    noise = np.sum(frf.variance[:, 0], axis=0)
    if not np.any(power > 0.0):
        return ()
    level_db = 10.0 * np.log10(np.maximum(power, np.finfo(np.float64).tiny))
    lines, _ = scipy.signal.find_peaks(level_db, prominence=PROMINENCE_DB)
    lines = lines[power[lines] > CLEAR_STD**2 * noise[lines]]
    widths = scipy.signal.peak_widths(power, lines, rel_height=0.5)[0]
    step_hz = float(frf.freq_hz[1] - frf.freq_hz[0])
    return tuple(
        Resonance(
            f_hz=float(frf.freq_hz[line]),
            half_width_hz=max(float(width) / 2.0, 1.0) * step_hz,
            line=int(line),
        )
        for line, width in zip(lines, widths, strict=True)
    )
