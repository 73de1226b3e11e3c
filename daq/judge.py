r"""Is the captured record one good hit? Judged in the time domain, on what was measured.

An anti-alias filter makes a short pulse ring close to its cut-off, some 0.3 to 0.49 of the
sampling rate, with lobes up to 20 % of the peak. The binomial kernel (1, 4, 6, 4, 1)/16 has the
gain :math:`\cos^4(\pi f / f_s)`, 12 % at 0.3 and 1 % at 0.4 of the rate: behind it the lobes of
Chebyshev, elliptic, Butterworth and FIR filters stay below 4 % of the peak for half-sines from
1.5 ms at 1652 Hz, so that a second peak of 6 % is a second pulse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks

from daq.blocks import CapturedBlock
from protocols.board.records import BoardDictionary, Channel
from protocols.board.samples import COUNT_MAX
from protocols.plan_records import Sampling, Trigger
from protocols.session.records import Verdict

__all__ = ["FORCE", "JudgeLimits", "channels_of", "force_column", "judge_record"]

FORCE = "force"

Signal = npt.NDArray[np.float64]

_KERNEL = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
_RINGING_REACH = 16  # samples before the trigger that a linear-phase filter may already move
_FEWEST_QUIET = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgeLimits:
    """Where the judge draws the line.

    double : second peak over the highest, both smoothed.
    noise : peaks below this many standard deviations of the pre-trigger are noise.
    clip : share of an input's full scale that counts as overloaded; a converter's filter smears
        a clipped top, so it lies a little below 1.
    soft : lowest peak force, in trigger levels.
    late_s : longest time from trigger to peak; five samples are always allowed.
    settled : largest pre-trigger vibration (rms) over the peak of the response.
    moved : largest change of a joint from before to after, in tolerances of the posture.
    """

    double: float = 0.06
    noise: float = 6.0
    clip: float = 0.98
    soft: float = 2.0
    late_s: float = 0.02
    settled: float = 0.15
    moved: float = 0.25


def channels_of(dictionary: BoardDictionary, channel_mask: int) -> tuple[Channel, ...]:
    """Return the channels in the mask, in the order of the record's columns."""
    return tuple(c for i, c in enumerate(dictionary.channels) if channel_mask >> i & 1)


def force_column(channels: tuple[Channel, ...]) -> int:
    """Return the column of the first force channel, or raise ValueError."""
    for column, channel in enumerate(channels):
        if channel.quantity == FORCE:
            return column
    raise ValueError("wanted a force channel, got " + ", ".join(c.quantity for c in channels))


def judge_record(
    block: CapturedBlock,
    channels: tuple[Channel, ...],
    sampling: Sampling,
    trigger: Trigger,
    limits: JudgeLimits | None = None,
) -> Verdict:
    """Judge the samples of one block; posture and motion are judged elsewhere.

    Parameters
    ----------
    block
        Counts (n, n_channels).
    channels
        One for each column.

    Returns
    -------
    Verdict
        `width_s` is the full width at half the peak, by straight lines between samples.
    """
    limits = limits or JudgeLimits()
    reasons: list[str] = []
    notes: list[str] = []
    if block.missing:
        reasons.append("gap")
        notes.append(f"{block.missing} of {block.info.length} samples never came")
    if not block.counts.shape[0]:
        return _verdict(reasons, notes, float("nan"), float("nan"))
    rate_hz = float(sampling.rate_hz)
    column = force_column(channels)
    force_n: Signal = block.counts[:, column] * np.float64(channels[column].scale)
    start = block.info.trigger_sample - block.first_sample
    quiet = force_n[: max(min(start, len(force_n)) - _RINGING_REACH, 0)]
    if quiet.size >= _FEWEST_QUIET:
        force_n = force_n - np.float64(np.median(quiet))
    if not trigger.rising:
        force_n = -force_n
    peak_at = int(np.argmax(force_n))
    peak_n = float(force_n[peak_at])
    clipped = _clipped(block.counts, channels, limits.clip)
    if clipped:
        reasons.append("overload")
        notes.append("at the end of the range: " + ", ".join(clipped))
    if peak_n < limits.soft * abs(trigger.level_n):
        reasons.append("soft")
        notes.append(f"peak {peak_n:.3g} N, wanted {limits.soft * abs(trigger.level_n):.3g} N")
    doubles = _other_peaks(force_n, quiet, limits)
    if doubles:
        reasons.append("double")
        notes.append(
            "more than one pulse, at "
            + ", ".join(f"{1e3 * (i - start) / rate_hz:.1f} ms" for i in doubles[:4])
        )
    if not block.missing and (
        abs(start - sampling.pretrigger) > 1
        or not -2 <= peak_at - start <= max(5.0, limits.late_s * rate_hz)
    ):
        reasons.append("late")
        notes.append(f"peak {1e3 * (peak_at - start) / rate_hz:.1f} ms after the trigger")
    unsettled = _unsettled(block.counts, channels, start, limits.settled)
    if unsettled:
        reasons.append("not-settled")
        notes.append("still vibrating before the hit: " + ", ".join(unsettled))
    return _verdict(reasons, notes, peak_n, _half_width(force_n, peak_at) / rate_hz)


def _verdict(reasons: list[str], notes: list[str], peak_n: float, width_s: float) -> Verdict:
    return Verdict(
        accepted=not reasons,
        reasons=tuple(reasons),
        notes=tuple(notes),
        peak_n=peak_n,
        width_s=width_s,
    )


def _clipped(
    counts: npt.NDArray[np.int32], channels: tuple[Channel, ...], share: float
) -> list[str]:
    extremes = np.maximum(counts.max(axis=0), -counts.min(axis=0).astype(np.int64))
    return [
        channel.name
        for channel, extreme in zip(channels, extremes, strict=True)
        if extreme >= share * min(channel.full_scale / abs(channel.scale), COUNT_MAX)
    ]


def _other_peaks(
    force_n: npt.NDArray[np.float64], quiet: npt.NDArray[np.float64], limits: JudgeLimits
) -> list[int]:
    """Return the samples of pulses beside the highest."""
    if len(force_n) < len(_KERNEL):
        return []
    smooth = np.convolve(force_n, _KERNEL, mode="same")
    highest = int(np.argmax(smooth))
    least = limits.double * float(smooth[highest])
    if quiet.size >= _FEWEST_QUIET:
        least = max(least, limits.noise * float(quiet.std()))
    if least <= 0.0:
        return []
    peaks, _ = find_peaks(smooth, height=least, prominence=least)
    return [int(peak) for peak in peaks if peak != highest]


def _half_width(force_n: npt.NDArray[np.float64], peak_at: int) -> float:
    """Full width at half the peak in samples; nan where the record ends before."""
    half = 0.5 * force_n[peak_at]
    below = np.flatnonzero(force_n < half)
    left = below[below < peak_at]
    right = below[below > peak_at]
    if half <= 0.0 or not left.size or not right.size:
        return float("nan")
    i, j = int(left[-1]), int(right[0])
    rise = i + (half - force_n[i]) / (force_n[i + 1] - force_n[i])
    fall = j - (half - force_n[j]) / (force_n[j - 1] - force_n[j])
    return float(fall - rise)


def _unsettled(
    counts: npt.NDArray[np.int32], channels: tuple[Channel, ...], start: int, share: float
) -> list[str]:
    """Name the responses that vibrate before the hit, clearly above their own noise.

    Differences of neighbouring samples hold the noise but hardly the slow vibration of an arm:
    rms of the pre-trigger many times theirs is motion.
    """
    n_quiet = start - _RINGING_REACH
    if n_quiet < _FEWEST_QUIET:
        return []
    responses = [i for i, channel in enumerate(channels) if channel.quantity != FORCE]
    scaled = counts[:, responses] * np.array([channels[i].scale for i in responses])
    before = scaled[:n_quiet] - scaled[:n_quiet].mean(axis=0)
    rms = np.sqrt(np.mean(before**2, axis=0))
    noise = np.diff(before, axis=0).std(axis=0) / np.sqrt(2.0)
    # One direction may hardly answer the hit: the largest of all is the measure of each.
    largest = float(np.abs(scaled[start:]).max(initial=0.0))
    return [
        channels[i].name
        for i, level, floor in zip(responses, rms, noise, strict=True)
        if level > share * largest and level > 3.0 * floor
    ]
