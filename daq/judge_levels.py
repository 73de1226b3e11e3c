"""Levels of the channels: overload, vibration before the hit, noise, vibration at the end."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.daq.judge_pulses import FEWEST_QUIET
from armodal.protocols.board.records import Channel
from armodal.protocols.board.samples import COUNT_MAX

__all__ = ["FORCE", "clipped", "lost_in_noise", "still_ringing", "stuck", "unsettled"]

FORCE = "force"

Counts = npt.NDArray[np.int32]
Signal = npt.NDArray[np.float64]

_CLEAR_OF_NOISE = 3.0  # rms over the noise's from which it is vibration
_END_SHARE = 16  # the record's last sixteenth is its end
_STUCK = 32  # equal counts in a row after the hit: no input of 24 bit is so quiet
_RISEN = 2.0  # largest value after the hit over the largest before that is no mere noise


def clipped(counts: Counts, channels: tuple[Channel, ...], share: float) -> list[str]:
    """Name the channels, force or response, that come to a share of their full scale."""
    extremes = np.maximum(counts.max(axis=0), -counts.min(axis=0).astype(np.int64))
    return [
        channel.name
        for channel, extreme in zip(channels, extremes, strict=True)
        if extreme >= share * min(channel.full_scale / abs(channel.scale), COUNT_MAX)
    ]


def stuck(counts: Counts, channels: tuple[Channel, ...], start: int) -> list[str]:
    """Name the responses that repeat one count for a while after the hit."""
    after = counts[max(start, 0) :]
    if len(after) < _STUCK:
        return []
    n = _STUCK - 1  # differences between as many counts
    changes = np.cumsum(np.diff(after, axis=0) != 0, axis=0)
    still = (changes[n - 1 :] == np.vstack([0 * changes[:1], changes[:-n]])).any(axis=0)
    return [
        channel.name
        for channel, is_still in zip(channels, still, strict=True)
        if is_still and channel.quantity != FORCE
    ]


def unsettled(
    counts: Counts, channels: tuple[Channel, ...], quiet: int, start: int, share: float
) -> list[str]:
    """Name the responses that vibrate before the hit, clearly above their own noise.

    Differences of neighbouring samples hold the noise but hardly the slow vibration of an arm:
    rms of the first `quiet` samples many times theirs is motion.
    """
    if quiet < FEWEST_QUIET:
        return []
    names, values = _responses(counts, channels)
    before = values[:quiet] - values[:quiet].mean(axis=0)
    rms = np.sqrt(np.mean(before**2, axis=0))
    noise = np.diff(before, axis=0).std(axis=0) / np.sqrt(2.0)
    # One direction may hardly answer the hit: the largest of all is the measure of each.
    largest = float(np.abs(values[start:]).max(initial=0.0))
    return [
        name
        for name, level, floor in zip(names, rms, noise, strict=True)
        if level > share * largest and level > _CLEAR_OF_NOISE * floor
    ]


def lost_in_noise(
    counts: Counts, channels: tuple[Channel, ...], quiet: int, start: int
) -> list[str]:
    """Name the responses whose largest value after the hit is about the largest before it."""
    if quiet < FEWEST_QUIET:
        return []
    names, values = _responses(counts, channels)
    middle = np.median(values[:quiet], axis=0)
    before = np.abs(values[:quiet] - middle).max(axis=0)
    after = np.abs(values[start:] - middle).max(axis=0, initial=0.0)
    return [name for name, b, a in zip(names, before, after, strict=True) if a <= _RISEN * b]


def still_ringing(
    counts: Counts, channels: tuple[Channel, ...], quiet: int, start: int, share: float
) -> list[tuple[str, float]]:
    """Name the responses that have not decayed to a share of their peak, with what is left.

    What is left is the amplitude of a sine of the rms of the record's last sixteenth, less the
    noise before the hit where that is known.
    """
    names, values = _responses(counts, channels)
    n_end = len(values) // _END_SHARE
    if n_end < FEWEST_QUIET or start >= len(values) - n_end:
        return []
    end = values[-n_end:].var(axis=0)
    if quiet >= FEWEST_QUIET:
        noise = values[:quiet].var(axis=0)
        end = np.where(end > _CLEAR_OF_NOISE * noise, end - noise, 0.0)
    middle = np.median(values, axis=0)
    peak = np.abs(values[max(start, 0) :] - middle).max(axis=0)
    left = np.sqrt(2.0 * end) / np.maximum(peak, np.finfo(float).tiny)
    return [(name, float(a)) for name, a in zip(names, left, strict=True) if a > share]


def _responses(counts: Counts, channels: tuple[Channel, ...]) -> tuple[list[str], Signal]:
    columns = [i for i, channel in enumerate(channels) if channel.quantity != FORCE]
    scales = np.array([channels[i].scale for i in columns])
    values: Signal = counts[:, columns] * scales
    return [channels[i].name for i in columns], values
