"""Where samples come from: the one interface between a device's driver and the board it becomes."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

import numpy as np
import numpy.typing as npt

from armodal.protocols.board.samples import COUNT_MAX, COUNT_MIN

__all__ = ["Chunk", "SampleSource", "to_counts"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Chunk:
    """Consecutive samples of all channels.

    counts : (n, n_channels) int32
        Of 24 bits.
    ready_s
        Lab time at which the first of them was ready.
    lost
        Samples that the device says it has lost before them.
    """

    counts: npt.NDArray[np.int32]
    ready_s: float
    lost: int = 0


class SampleSource(Protocol):
    """A device that samples; its channels are those of the front-end file, in order."""

    driver: str  # what samples, with its version
    teds: tuple[bytes, ...]  # of each channel the sensor's own data sheet; () where none is read

    def rate_refusal(self, rate_hz: Fraction) -> str:
        """Return why the device does not make a rate exactly; empty where it does."""

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        """Begin to sample at a rate that was not refused; `now_s` is lab time."""

    def stop(self) -> None:
        """Sample no more."""

    def read(self, now_s: float) -> list[Chunk]:
        """Return what has come since the last time, in order; never waits.

        Raises
        ------
        DeviceLostError
            If the device has gone, or its clock stands still.
        """

    def close(self) -> None:
        """Let go of the device; never raises."""


def to_counts(values: npt.NDArray[np.float64]) -> npt.NDArray[np.int32]:
    """Return counts of numbers whose full scale is 1; beyond it, the extreme count.

    >>> to_counts(np.array([[0.5, -2.0]]))
    array([[ 4194304, -8388608]], dtype=int32)
    """
    counts = np.rint(values * (COUNT_MAX + 1.0))
    return np.clip(counts, COUNT_MIN, COUNT_MAX).astype(np.int32)
