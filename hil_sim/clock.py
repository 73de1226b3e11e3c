"""The laboratory's clock, and the board's own clock that is not quite the same."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

__all__ = ["DeviceClock", "LabClock", "SampleClock"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LabClock:
    """Lab seconds: those of the machine's monotonic clock times `scale`.

    The monotonic clock is one for the whole machine, so processes agree on the lab time.

    >>> LabClock(scale=16.0, monotonic=lambda: 2.0).now_s()
    32.0
    """

    scale: float = 1.0
    monotonic: Callable[[], float] = time.monotonic

    def __post_init__(self) -> None:
        """Refuse a clock that stands still or runs backwards."""
        if not 0.0 < self.scale < float("inf"):
            raise ValueError(
                f"time scale: wanted a positive number such as 1 or 16, got {self.scale}"
            )

    def now_s(self) -> float:
        """Return the lab time in seconds."""
        return self.monotonic() * self.scale


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceClock:
    """The board's tick counter: `error_ppm` fast against lab time, 0 at `boot_s`."""

    lab: LabClock
    boot_s: float
    tick_hz: int = 1_000_000
    error_ppm: float = 0.0
    offset_ticks: int = 0

    def ticks(self) -> int:
        """Return the counter as it stands."""
        return self.ticks_at(self.lab.now_s())

    def ticks_at(self, lab_s: float) -> int:
        """Return the counter at lab time `lab_s`."""
        elapsed_s = (lab_s - self.boot_s) * (1.0 + 1e-6 * self.error_ppm)
        return self.offset_ticks + max(0, int(elapsed_s * self.tick_hz))


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleClock:
    """When samples are ready, in ticks; sample 0 at `start_ticks`.

    >>> clock = SampleClock(rate_hz=Fraction(1000), tick_hz=1_000_000, start_ticks=5)
    >>> clock.ready_ticks(2), clock.due(2004), clock.due(2005)
    (2005, 2, 3)
    """

    rate_hz: Fraction
    tick_hz: int
    start_ticks: int

    def ready_ticks(self, sample: int) -> int:
        """Return the first tick at which `sample` is ready."""
        ticks = -(-sample * self.tick_hz * self.rate_hz.denominator // self.rate_hz.numerator)
        return self.start_ticks + ticks

    def due(self, ticks: int) -> int:
        """Return how many samples are ready at `ticks`."""
        if ticks < self.start_ticks:
            return 0
        elapsed = (ticks - self.start_ticks) * self.rate_hz.numerator
        return elapsed // (self.tick_hz * self.rate_hz.denominator) + 1
