"""When samples were taken, for devices that count samples and tell no time."""

from __future__ import annotations

from collections import deque

from armodal.protocols.errors import DeviceLostError

__all__ = ["SampleTimes"]

WINDOW_S = 20.0  # two crystals 100 ppm apart differ by 2 ms after it
STANDS_STILL_S = 1.0


class SampleTimes:
    """Lab time of samples, from when they were read.

    A sample is never read before it is taken: of the times at which sample 0 would have been taken
    by each reading, the earliest of the last seconds is the truest. Older ones are forgotten, since
    the device's crystal is not the computer's.

    Parameters
    ----------
    name
        Of the device, for errors.
    rate_hz
        Its sample rate.
    now_s
        Lab time of the start.
    """

    def __init__(self, name: str, rate_hz: float, now_s: float) -> None:
        self._name = name
        self._rate_hz = rate_hz
        self._seen: deque[tuple[float, float]] = deque()  # read at, start by this reading; rising
        self._last_s = now_s
        self.samples = 0

    def lost(self, count: int) -> None:
        """Samples that were taken and will never be read."""
        self.samples += count

    def add(self, count: int, now_s: float) -> float:
        """Note a reading of `count` samples, all taken by `now_s`; return when the first was."""
        first = self.samples
        self.samples += count
        self._last_s = now_s
        begun_s = now_s - (self.samples - 1) / self._rate_hz
        while self._seen and self._seen[-1][1] >= begun_s:
            self._seen.pop()
        self._seen.append((now_s, begun_s))
        while self._seen[0][0] < now_s - WINDOW_S:
            self._seen.popleft()
        return self._seen[0][1] + first / self._rate_hz

    def check(self, now_s: float) -> None:
        """Raise DeviceLostError where nothing was read for long: the clock stands still."""
        if now_s - self._last_s > STANDS_STILL_S:
            raise DeviceLostError(
                f"{self._name} has told no sample for {STANDS_STILL_S:g} s: its sample clock does "
                "not advance; check power, cable and clock source, then resume"
            )
