"""The pulses in a force record: the highest, and every other one.

A second pulse is a local maximum of the smoothed force that stands out from its surroundings by
more than (1) a share of the highest, (2) the noise, (3) what an anti-alias filter could leave at
that distance from one pulse as narrow as the highest. Smoothing is the binomial kernel of
`judge_anti_alias`, and for wide pulses a Gaussian of an eighth of their width besides, behind
which noise is smaller.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from daq.judge_anti_alias import REACH, SMOOTHING, largest_lobes, smoothed
from daq.judge_disturbance import without_disturbance

__all__ = ["FEWEST_QUIET", "OtherPulse", "Pulses", "find_pulses", "half_width"]

Signal = npt.NDArray[np.float64]

FEWEST_QUIET = 16
_WIDE = 12.0  # half width in samples from which the Gaussian is used besides
_GAUSSIAN = 0.12  # its standard deviation over the half width
_TOP = 0.25  # of the half width to either side belongs to one maximum
_LOBE_MARGIN = 1.25  # filters outside the bank
_STANDING = 0.5  # height over prominence that a pulse needs at least: undershoot takes some
_MAD = 1.4826  # standard deviation over median absolute deviation, normal noise


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
    force_n: Signal, rate_hz: float, *, double: float, noise: float, contact: float
) -> Pulses:
    """Find the pulses of a record.

    Parameters
    ----------
    force_n : (n,)
        Force, pulses upwards, about zero between them.
    rate_hz
        Sampling rate.
    double
        Prominence over the highest from which a maximum is another pulse.
    noise
        Prominence over the standard deviation of the smoothed noise likewise.
    contact
        Force between two pulses over the lower one from which the hammer has not let go.
    """
    peak_at = int(np.argmax(force_n))
    width = half_width(force_n, peak_at)
    reach = 3.0 * (width if np.isfinite(width) else 0.0) + REACH
    beside = np.abs(np.arange(len(force_n)) - peak_at) > reach
    level = without_disturbance(force_n, rate_hz, beside)
    peak_n = float(force_n[peak_at])
    noise_n = _deviation(level[beside])
    if len(force_n) < len(SMOOTHING) or peak_n <= 0.0:
        return Pulses(
            peak_at=peak_at, peak_n=peak_n, half_width=width, noise_n=noise_n, hidden=0.0, others=()
        )
    smooth = smoothed(level)
    main = int(np.argmax(smooth))
    versions = [(smooth, _allowed(len(smooth), main, width, double), 1.0)]
    if width > _WIDE:
        broad = gaussian_filter1d(level, _GAUSSIAN * width, mode="nearest")
        versions.append((broad, np.full(len(broad), double), _TOP * width))
    found: dict[int, float] = {}
    hidden = np.inf
    for signal, share, top in versions:
        highest_n = float(signal.max())
        floor_n = noise * _deviation(signal[beside])
        hidden = min(hidden, floor_n / highest_n)
        for at in _peaks(signal, share * highest_n, floor_n):
            if all(abs(at - known) > max(_TOP * width, 2.0) for known in found) and (
                abs(at - main) > top
            ):
                found[at] = float(signal[at]) / highest_n
    others = tuple(
        OtherPulse(
            at=at,
            share=found[at],
            released=_lowest(level, at, main) < contact * min(found[at], 1.0) * peak_n,
        )
        for at in sorted(found)
    )
    return Pulses(
        peak_at=peak_at,
        peak_n=peak_n,
        half_width=width,
        noise_n=noise_n,
        hidden=float(hidden),
        others=others,
    )


def half_width(force_n: Signal, peak_at: int) -> float:
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


def _allowed(n: int, peak_at: int, width: float, double: float) -> Signal:
    """Share of the highest that a maximum must exceed at each sample to be a pulse."""
    share = np.full(n, double)
    if np.isfinite(width):
        lobes = np.maximum(_LOBE_MARGIN * largest_lobes(width), double)
        before = min(peak_at, REACH)
        after = min(n - 1 - peak_at, REACH)
        share[peak_at - before : peak_at] = lobes[:before][::-1]
        share[peak_at + 1 : peak_at + 1 + after] = lobes[:after]
    return share


def _peaks(signal: Signal, least: Signal, floor: float) -> list[int]:
    """Local maxima beside the highest that stand out by more than `least` and `floor`."""
    lowest = max(float(least.min()), floor)
    peaks, found = find_peaks(signal, height=max(_STANDING * lowest, floor), prominence=lowest)
    return [int(peak) for peak in peaks[found["prominences"] >= least[peaks]]]


def _deviation(values: Signal) -> float:
    """Standard deviation, from the median absolute deviation; 0 of too few values."""
    if len(values) < FEWEST_QUIET:
        return 0.0
    return _MAD * float(np.median(np.abs(values - np.median(values))))


def _lowest(signal: Signal, first: int, second: int) -> float:
    return float(signal[min(first, second) : max(first, second) + 1].min())
