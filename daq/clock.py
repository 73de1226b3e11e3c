"""The laboratory's clock: every rate, age and limit of a session is told by it."""

from __future__ import annotations

import math
import select
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

from armodal.protocols.errors import SessionError

__all__ = ["Clock", "SystemClock", "check_time_scale", "waits"]


def check_time_scale(scale: float) -> None:
    """Raise SessionError unless a clock can run at so many lab seconds a second."""
    if not (math.isfinite(scale) and scale > 0.0):
        raise SessionError(
            f"time scale: wanted a finite number of lab seconds a second, above 0, got {scale!r}; "
            "leave it out in a real laboratory"
        )


class Clock(Protocol):
    """Lab seconds, and how long they last for the one who waits."""

    def now_s(self) -> float:
        """Return the lab time in seconds; it never runs backwards."""

    def sleep(self, lab_s: float) -> None:
        """Wait `lab_s` lab seconds."""

    def wall_s(self, lab_s: float) -> float:
        """Return how many seconds of a waiting process `lab_s` lab seconds are."""

    def wait(self, descriptors: Iterable[int], wall_s: float) -> list[int]:
        """Wait for at most `wall_s` seconds and return the descriptors that can be read."""


@dataclass(frozen=True, slots=True)
class SystemClock:
    """Lab seconds are monotonic seconds times `scale`; 1 in a real laboratory.

    The monotonic clock is one for the whole machine, so processes agree on the lab time.

    >>> SystemClock(scale=16.0).wall_s(8.0)
    0.5
    """

    scale: float = 1.0

    def __post_init__(self) -> None:
        """Refuse a clock that stands still or runs backwards."""
        check_time_scale(self.scale)

    def now_s(self) -> float:
        """Return the lab time in seconds."""
        return time.monotonic() * self.scale

    def sleep(self, lab_s: float) -> None:
        """Wait `lab_s` lab seconds."""
        if lab_s > 0.0:
            time.sleep(lab_s / self.scale)

    def wall_s(self, lab_s: float) -> float:
        """Return how many wall seconds `lab_s` lab seconds are."""
        return lab_s / self.scale

    def wait(self, descriptors: Iterable[int], wall_s: float) -> list[int]:
        """Wait for at most `wall_s` seconds and return the descriptors that can be read."""
        return select.select(list(descriptors), [], [], max(wall_s, 0.0))[0]


def waits(until: float, now: Callable[[], float]) -> Iterator[float]:
    """Yield how long to wait yet, and after that time 0 once: what came late is still read.

    >>> times = iter([0.25, 1.25])
    >>> list(waits(1.0, lambda: next(times)))
    [0.75, 0.0]
    """
    while (left := until - now()) > 0.0:
        yield left
    yield 0.0
