"""Joint angles that a controller tells all at once, again and again, at its own time."""

from __future__ import annotations

import math
from collections.abc import Sequence

from armodal.daq.joint_timeline import JointCycle, JointTimeline
from armodal.protocols.joint_sample import JointSample
from armodal.protocols.session.records import JointReading

__all__ = ["TimedJoints"]


class TimedJoints:
    """What the controller has told of the arm; times are lab seconds.

    Parameters
    ----------
    names
        Of the joints, base first.
    rate_hz
        How often it tells.
    stale_after_s
        Age beyond which angles are not believed.

    Attributes
    ----------
    frames, lost, invalid : int
        Words understood, left out by the controller's time, and not understood.
    """

    def __init__(self, names: Sequence[str], *, rate_hz: float, stale_after_s: float) -> None:
        self.rate_hz = rate_hz
        self._names = tuple(names)
        self._timeline = JointTimeline(stale_after_s=stale_after_s, rate_hz=rate_hz)
        self._last_s = -math.inf  # controller time
        self.frames = 0
        self.lost = 0
        self.invalid = 0

    @property
    def absent(self) -> tuple[str, ...]:
        """All joints until the first word."""
        return () if self._timeline.last else self._names

    def take(self, sample: JointSample | None, now_s: float) -> None:
        """Take in a word read at `now_s`; one whose time stands still tells nothing."""
        if sample is None:
            self.invalid += 1
            return
        if sample.timestamp_s is not None:
            step_s = sample.timestamp_s - self._last_s
            if step_s == 0.0:
                return
            self._last_s = sample.timestamp_s
            if 0.0 < step_s < math.inf:
                self.lost += max(round(step_s * self.rate_hz) - 1, 0)
        self.frames += 1
        self._timeline.add(
            JointCycle(
                oldest_s=now_s,
                newest_s=now_s,
                joints_rad=sample.joints_rad,
                drive_state=sample.drive_state,
                held=sample.held,
            )
        )

    def reading(self, now_s: float) -> JointReading:
        """Return what is known at `now_s`; joints None when it is stale."""
        last = self._timeline.last
        if last is None:
            return _unknown(now_s, math.inf, None)
        age_s = now_s - last.oldest_s
        if age_s > self._timeline.stale_after_s:
            return _unknown(now_s, age_s, last)
        return last.reading(now_s, age_s)

    def reading_before(self, host_s: float) -> JointReading:
        """Return the newest angles not later than `host_s`, aged at that time."""
        found, age_s = self._timeline.before(host_s)
        return _unknown(host_s, age_s, self._timeline.last) if found is None else found

    def reading_after(self, host_s: float) -> JointReading | None:
        """Return the first angles newer than `host_s`; None so far."""
        return self._timeline.after(host_s)

    def spread_rad(self, since_s: float, until_s: float = math.inf) -> float | None:
        """Return the largest range any joint covered in a time; None if it is not known."""
        return self._timeline.spread_rad(since_s, until_s)

    def silence_s(self, since_s: float, until_s: float) -> float:
        """Return for how long the controller told nothing between two times."""
        return self._timeline.silence_s(since_s, until_s)


def _unknown(host_s: float, age_s: float, last: JointCycle | None) -> JointReading:
    return JointReading(
        joints_rad=None,
        drive_state=None if last is None else last.drive_state,
        held=last is not None and last.held,
        age_s=max(age_s, 0.0),
        host_s=host_s,
    )
