"""Joint angles as the bus tells them, with their ages; none is ever assumed.

Times are those at which frames were read. A frame waits at most one turn of the acquisition
loop, so a time is late by no more than that, and never early.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from armodal.daq.joint_timeline import JointCycle, JointTimeline
from armodal.protocols.arm.records import CanMapping
from armodal.protocols.arrays import frozen_array
from armodal.protocols.can_database import CanDecoder
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError
from armodal.protocols.session.records import JointReading

__all__ = ["JointState", "largest_difference_rad"]


class JointState:
    """What is known of the arm's posture, now and a while back.

    Attributes
    ----------
    mapping : CanMapping
        Where in the frames the angles are.
    frames : int
        Frames of the mapping that were decoded.
    lost : int
        Frames skipped, by the controller's counter.
    invalid : int
        Frames of the mapping that could not be decoded.
    """

    def __init__(self, mapping: CanMapping, joint_names: Iterable[str]) -> None:
        self._names = tuple(joint_names)
        self.mapping = mapping
        self._timeline = JointTimeline(stale_after_s=mapping.stale_after_s, rate_hz=mapping.rate_hz)
        self._has_drive_state = mapping.drive_state is not None
        self._decoder = CanDecoder(mapping)
        self._latest: dict[str, tuple[float, float]] = {}  # joint: angle, time
        self._renewed: set[str] = set()
        self._drive_state: int | None = None
        self._held = not self._has_drive_state
        self.frames = 0
        self.lost = 0
        self.invalid = 0

    @property
    def rate_hz(self) -> float:
        """Cycles a lab second, by the arm file."""
        return self.mapping.rate_hz

    @property
    def absent(self) -> tuple[str, ...]:
        """Joints that have never been heard of."""
        return tuple(name for name in self._names if name not in self._latest)

    def feed(self, frames: Iterable[CanFrame], now_s: float) -> None:
        """Take in frames read at `now_s`."""
        for frame in frames:
            try:
                update = self._decoder.decode(frame)
            except CanError:
                self.invalid += 1
                continue
            if update is None:
                continue
            self.frames += 1
            self.lost += update.lost
            if update.held is not None:
                self._held = update.held
                self._drive_state = update.drive_state
            for joint, angle in update.joints_rad.items():
                self._latest[joint] = (angle, now_s)
                self._renewed.add(joint)
            if self._renewed.issuperset(self._names):
                self._close_cycle()

    def reading(self, now_s: float) -> JointReading:
        """Return what is known at `now_s`; joints None when any is absent or stale."""
        if self.absent:
            return self._unknown(now_s, math.inf)
        age_s = now_s - min(self._latest[name][1] for name in self._names)
        if age_s > self.mapping.stale_after_s:
            return self._unknown(now_s, age_s)
        return JointReading(
            joints_rad=frozen_array([self._latest[name][0] for name in self._names], np.float64),
            drive_state=self._drive_state,
            held=self._held,
            age_s=max(age_s, 0.0),
            host_s=now_s,
        )

    def reading_before(self, host_s: float) -> JointReading:
        """Return the newest full set of angles not later than `host_s`, aged at that time."""
        found, age_s = self._timeline.before(host_s)
        return self._unknown(host_s, age_s) if found is None else found

    def reading_after(self, host_s: float) -> JointReading | None:
        """Return the first full set of angles that is all newer than `host_s`; None so far."""
        return self._timeline.after(host_s)

    def spread_rad(self, since_s: float, until_s: float = math.inf) -> float | None:
        """Return the largest range any joint covered in a time; None if it is not known."""
        return self._timeline.spread_rad(since_s, until_s)

    def silence_s(self, since_s: float, until_s: float) -> float:
        """Return for how long the bus told nothing of the arm between two times."""
        return self._timeline.silence_s(since_s, until_s)

    def _close_cycle(self) -> None:
        self._renewed.clear()
        times = [self._latest[name][1] for name in self._names]
        self._timeline.add(
            JointCycle(
                oldest_s=min(times),
                newest_s=max(times),
                joints_rad=tuple(self._latest[name][0] for name in self._names),
                drive_state=self._drive_state,
                held=self._held,
            )
        )

    def _unknown(self, host_s: float, age_s: float) -> JointReading:
        return JointReading(
            joints_rad=None,
            drive_state=self._drive_state,
            held=False if self._has_drive_state and math.isinf(age_s) else self._held,
            age_s=max(age_s, 0.0),
            host_s=host_s,
        )


def largest_difference_rad(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> float:
    """Return the largest distance of two postures in any joint, rad.

    >>> largest_difference_rad(np.array([0.0, 1.0]), np.array([0.5, 0.75]))
    0.5
    """
    return float(np.abs(a - b).max(initial=0.0))
