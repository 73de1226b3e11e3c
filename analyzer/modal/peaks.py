"""Peaks that stand far above their surroundings: each must have a mode, or be told.

Fitting decides what a mode is, but nobody believes a table that lacks what everybody sees. The
FRFs' mean power, each in units of its own median, is held against its running median.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.running_median import running_median

__all__ = ["Peak", "peak_poles", "standing_peaks", "unexplained"]

HEIGHT = 10.0  # of a peak over its surroundings, in amplitude: 20 dB
SURROUNDINGS = 81  # lines whose median is the surroundings
NEAR_LINES = 2.0  # between a peak and the mode that explains it, if its bandwidth is less


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A line where the FRFs stand out."""

    f_hz: float
    height: float  # amplitude over that of the surroundings
    half_width_hz: float  # where the power has fallen to half


def standing_peaks(
    freq_hz: npt.NDArray[np.float64], values: npt.NDArray[np.complex128]
) -> tuple[Peak, ...]:
    """Peaks of the FRFs' mean power, by frequency.

    Parameters
    ----------
    freq_hz
        (n_freq,).
    values
        (n_resp, n_ref, n_freq), any form.
    """
    power = np.abs(values.reshape(-1, freq_hz.size)) ** 2
    median = np.median(power, axis=1, keepdims=True)
    seen = median[:, 0] > 0.0
    if not seen.any():
        return ()
    level = np.mean(power[seen] / median[seen], axis=0)
    width = min(SURROUNDINGS, freq_hz.size)
    around = np.maximum(running_median(level, width), np.finfo(float).tiny)
    out = level > HEIGHT**2 * around
    edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(np.int8), [0]])))
    peaks = []
    for first, end in edges.reshape(-1, 2):
        top = first + int(np.argmax(level[first:end]))
        if top in (0, freq_hz.size - 1):
            continue  # a flank: its peak is outside the band
        half = level >= 0.5 * level[top]
        low = top - int(np.argmin(half[top::-1])) + 1 if not half[: top + 1].all() else 0
        high = top + int(np.argmin(half[top:])) - 1 if not half[top:].all() else freq_hz.size - 1
        step = float(freq_hz[top + 1] - freq_hz[top - 1]) / 2.0
        peaks.append(
            Peak(
                f_hz=float(freq_hz[top]),
                height=float(np.sqrt(level[top] / around[top])),
                half_width_hz=max(float(freq_hz[high] - freq_hz[low]) / 2.0, step / 2.0),
            )
        )
    return tuple(peaks)


def peak_poles(peaks: Sequence[Peak]) -> npt.NDArray[np.complex128]:
    """Poles to begin from where no polynomial found one: (n,) rad/s."""
    return np.array(
        [2.0 * np.pi * (-peak.half_width_hz + 1j * peak.f_hz) for peak in peaks],
        dtype=np.complex128,
    )


def unexplained(
    peaks: Sequence[Peak], poles: npt.NDArray[np.complex128], line_spacing_hz: float
) -> tuple[Peak, ...]:
    """Peaks that no pole stands at, within its half bandwidth or two lines."""
    f, half = poles.imag / (2.0 * np.pi), -poles.real / (2.0 * np.pi)
    return tuple(
        peak
        for peak in peaks
        if not np.any(
            np.abs(f - peak.f_hz)
            <= np.maximum(half + peak.half_width_hz, NEAR_LINES * line_spacing_hz)
        )
    )
