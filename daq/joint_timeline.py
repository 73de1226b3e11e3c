"""Full sets of joint angles in order of time, and what they tell of the arm in between."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.session.records import JointReading

__all__ = ["JointCycle", "JointTimeline"]

KEPT_CYCLES = 8192


@dataclass(frozen=True, slots=True, kw_only=True)
class JointCycle:
    """All joints, each newer than in the cycle before; times are lab seconds."""

    oldest_s: float
    newest_s: float
    joints_rad: tuple[float, ...]
    drive_state: int | None
    held: bool

    def reading(self, host_s: float, age_s: float) -> JointReading:
        """Return the angles as they are known at a time."""
        return JointReading(
            joints_rad=frozen_array(self.joints_rad, np.float64),
            drive_state=self.drive_state,
            held=self.held,
            age_s=max(age_s, 0.0),
            host_s=host_s,
        )


class JointTimeline:
    """The last cycles of a controller.

    Parameters
    ----------
    stale_after_s
        Age beyond which angles are not believed.
    rate_hz
        Cycles a lab second that the controller should send.
    """

    def __init__(self, *, stale_after_s: float, rate_hz: float) -> None:
        self.stale_after_s = stale_after_s
        self.rate_hz = rate_hz
        self._cycles: deque[JointCycle] = deque(maxlen=KEPT_CYCLES)

    @property
    def last(self) -> JointCycle | None:
        """The newest cycle."""
        return self._cycles[-1] if self._cycles else None

    def add(self, cycle: JointCycle) -> None:
        """Take the next cycle in."""
        self._cycles.append(cycle)

    def before(self, host_s: float) -> tuple[JointReading | None, float]:
        """Return the newest angles not later than `host_s`, and their age then.

        The angles are None where there are none (age infinite) or they are stale.
        """
        for cycle in reversed(self._cycles):
            if cycle.newest_s <= host_s:
                age_s = host_s - cycle.oldest_s
                if age_s > self.stale_after_s:
                    return None, age_s
                return cycle.reading(host_s, age_s), age_s
        return None, math.inf

    def after(self, host_s: float) -> JointReading | None:
        """Return the first full set of angles that is all newer than `host_s`; None so far."""
        found = None
        for cycle in reversed(self._cycles):
            if cycle.oldest_s <= host_s:
                break
            found = cycle
        return None if found is None else found.reading(found.newest_s, 0.0)

    def spread_rad(self, since_s: float, until_s: float = math.inf) -> float | None:
        """Return the largest range any joint covered in a time; None if it is not known."""
        angles = []
        for cycle in reversed(self._cycles):
            if cycle.oldest_s <= until_s:
                angles.append(cycle.joints_rad)
            if cycle.oldest_s <= since_s:
                return float(np.ptp(np.array(angles), axis=0).max())
        return None

    def silence_s(self, since_s: float, until_s: float) -> float:
        """Return for how long nothing was told of the arm between two times.

        What was read late comes together, so a pause counts only as far as cycles are missing by
        the controller's rate.
        """
        times = [cycle.newest_s for cycle in self._cycles if since_s < cycle.newest_s <= until_s]
        longest_s = float(np.diff([since_s, *times, until_s]).max())
        missing_s = until_s - since_s - len(times) / self.rate_hz
        return max(min(longest_s, missing_s), 0.0)
