"""The pulses in a force record: the highest, and every other one.

Another pulse is a local maximum that stands out from its surroundings by more than a share of the
highest, and more than the noise. Where it is looked for depends on the highest pulse's width:

- narrower than 2.75 samples at half its peak: in what the templates of `judge_anti_alias` leave,
  smoothed by (1, 2, 1)/4, outside the seven samples they were compared on, and near the pulse
  only what stands out half as much again as the deepest trough;
- wider: in the force smoothed by (1, 4, 6, 4, 1)/16;
- wider than twelve: besides, in the force behind a Gaussian of an eighth of the width, where noise
  is smaller.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.daq.judge_anti_alias import COMPARED, NARROW_KERNEL, WIDE_KERNEL, without_narrow_pulse
from armodal.daq.judge_disturbance import without_disturbance, without_undershoot

__all__ = ["FEWEST_QUIET", "OtherPulse", "Pulses", "find_pulses"]

Signal = npt.NDArray[np.float64]

FEWEST_QUIET = 16
_NARROW = 2.75  # half width in samples below which the filter's lobes count
_WIDE = 12.0  # half width in samples from which the Gaussian is used besides
_GAUSSIAN = 0.12  # its standard deviation over the half width
_TOP = 0.25  # of the half width to either side belongs to one maximum
_STANDING = 0.75  # least height over prominence: undershoot takes some
_BESIDE = 1.2  # half widths from the peak on that are beside the pulse
_RINGING = 32  # samples that an anti-alias filter may ring on
_ABOVE_TROUGHS = 1.5  # what is left of ringing swings both ways, a pulse hardly
_MAD = 1.4826  # standard deviation over median absolute deviation, normal noise
_FAR = 4.0  # standard deviations


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherPulse:
    """A pulse beside the highest.

    `released` says whether the force fell to nearly nothing between the two.
    """

    at: int  # sample
    share: float  # of the highest
    released: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulses:
    """What a force record holds.

    `half_width` is in samples, nan where the record cuts the pulse off. `hidden` is the largest
    second pulse, over the highest, that would not be told from noise.
    """

    peak_at: int
    peak_n: float
    half_width: float
    noise_n: float  # standard deviation of the force beside the pulses
    hidden: float
    others: tuple[OtherPulse, ...]


def find_pulses(
    force_n: Signal,
    rate_hz: float,
    *,
    highpass_hz: float,
    double: float,
    noise: float,
    contact: float,
) -> Pulses:
    """Find the pulses of a record.

    Parameters
    ----------
    force_n : (n,)
        Force, pulses upwards, about zero between them.
    rate_hz
        Sampling rate.
    highpass_hz
        First-order corner of the force channel; 0 is DC coupled.
    double
        Prominence over the highest from which a maximum is another pulse.
    noise
        Prominence over the standard deviation of the smoothed noise likewise.
    contact
        Force between two pulses over the lower one from which the hammer has not let go.
    """
    peak_at = int(np.argmax(force_n))
    width = _half_width(force_n, peak_at)
    known_width = width if np.isfinite(width) else 0.0
    beside = np.abs(np.arange(len(force_n)) - peak_at) > _BESIDE * known_width + _RINGING
    level = without_undershoot(force_n, rate_hz, highpass_hz)
    if noise * _deviation(level[beside]) > double * force_n[peak_at]:
        level = without_disturbance(level, rate_hz, beside)
    others: dict[int, float] = {}
    hidden = np.inf
    main = peak_at
    if len(force_n) >= len(WIDE_KERNEL) and force_n[peak_at] > 0.0:
        smooth = np.convolve(level, WIDE_KERNEL, mode="same")
        main = int(np.argmax(smooth))
        for view in _views(level, smooth, main, width):
            floor_n = noise * _deviation(view.signal[beside])
            hidden = min(hidden, floor_n / (view.kept * view.highest_n))
            for at in _maxima(view.signal, double * view.highest_n, floor_n):
                apart = all(abs(at - other) > max(_TOP * known_width, 2.0) for other in others)
                clear = view.signal[at] >= view.least_near_n or abs(at - view.top) > _RINGING
                if apart and clear and abs(at - view.top) > view.reach:
                    others[at] = float(view.signal[at]) / view.highest_n
    return Pulses(
        peak_at=peak_at,
        peak_n=float(force_n[peak_at]),
        half_width=width,
        noise_n=_deviation(level[beside]),
        hidden=float(hidden),
        others=tuple(
            OtherPulse(
                at=at,
                share=share,
                released=_lowest(level, at, main) < contact * min(share, 1.0) * level[main],
            )
            for at, share in sorted(others.items())
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _View:
    """A signal to look for other pulses in.

    Maxima within `reach` samples of `top` are the highest pulse's own; those as near as a filter
    may ring must come to `least_near_n`. Smoothing leaves `kept` of a pulse like the highest.
    """

    signal: Signal
    highest_n: float
    top: int
    reach: float
    least_near_n: float = 0.0
    kept: float = 1.0


def _views(level: Signal, smooth: Signal, main: int, width: float) -> list[_View]:
    if width < _NARROW:
        top = max(range(max(main - 1, 0), min(main + 2, len(level))), key=lambda i: level[i])
        rest = np.convolve(without_narrow_pulse(level, top), NARROW_KERNEL, mode="same")
        near = np.abs(np.arange(len(rest)) - top)
        troughs = rest[(near > COMPARED) & (near <= _RINGING)]
        least_near_n = -_ABOVE_TROUGHS * float(troughs.min(initial=0.0))
        return [
            _View(
                signal=rest,
                highest_n=float(level[top]),
                top=top,
                reach=COMPARED,
                least_near_n=least_near_n,
                kept=float(np.convolve(level, NARROW_KERNEL, mode="same")[top] / level[top]),
            )
        ]
    views = [_View(signal=smooth, highest_n=float(smooth[main]), top=main, reach=0.0)]
    if width > _WIDE:
        broad = scipy.ndimage.gaussian_filter1d(level, _GAUSSIAN * width, mode="nearest")
        views.append(
            _View(signal=broad, highest_n=float(broad.max()), top=main, reach=_TOP * width)
        )
    return views


def _half_width(force_n: Signal, peak_at: int) -> float:
    """Full width at half the peak in samples, by straight lines; nan where the record ends."""
    half = 0.5 * force_n[peak_at]
    below = np.flatnonzero(force_n < half)
    i = int(np.searchsorted(below, peak_at)) - 1
    if half <= 0.0 or i < 0 or i + 1 >= len(below):
        return float("nan")
    left, right = int(below[i]), int(below[i + 1])
    rise = left + (half - force_n[left]) / (force_n[left + 1] - force_n[left])
    fall = right - (half - force_n[right]) / (force_n[right - 1] - force_n[right])
    return float(fall - rise)


def _maxima(signal: Signal, least_n: float, floor_n: float) -> list[int]:
    """Local maxima that stand out by more than `least_n` and `floor_n`."""
    peaks, _ = scipy.signal.find_peaks(
        signal, height=max(_STANDING * least_n, floor_n), prominence=max(least_n, floor_n)
    )
    return [int(peak) for peak in peaks]


def _deviation(values: Signal) -> float:
    """Standard deviation from the median absolute deviation; 0 of too few values.

    Values farther off than four of them are left out and the deviation is taken again, twice, so
    that a second pulse hardly counts as noise.
    """
    deviation = 0.0
    for _ in range(3):
        if len(values) < FEWEST_QUIET:
            break
        off = np.abs(values - np.median(values))
        deviation = _MAD * float(np.median(off))
        values = values[off <= _FAR * deviation]
    return deviation


def _lowest(signal: Signal, first: int, second: int) -> float:
    return float(signal[min(first, second) : max(first, second) + 1].min())
