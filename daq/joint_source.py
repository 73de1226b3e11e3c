"""Where joint angles come from: the one interface that loop, judge and screens know.

None has a way to move the robot or to write to it.
"""

from __future__ import annotations

import math
from typing import Protocol

from armodal.daq.can_listener import CanSource
from armodal.daq.commands import StatedPosture
from armodal.daq.joint_state import JointState
from armodal.protocols.plan_records import PlannedPosture
from armodal.protocols.session.records import JointReading

__all__ = ["CanJoints", "JointSource", "Joints", "MeasuredAngles"]


class Joints(Protocol):
    """What is known of the arm's posture; times are lab seconds."""

    frames: int  # words of the arm that were understood
    lost: int  # words that the sender's counter skipped
    invalid: int  # words that could not be understood

    @property
    def absent(self) -> tuple[str, ...]:
        """Joints of which nothing has ever been told."""

    @property
    def rate_hz(self) -> float | None:
        """How often angles come; None where they are told once for a posture."""

    def reading(self, now_s: float) -> JointReading:
        """Return what is known at `now_s`; joints None when any is absent or stale."""

    def reading_before(self, host_s: float) -> JointReading:
        """Return the newest angles not later than `host_s`, aged at that time."""

    def reading_after(self, host_s: float) -> JointReading | None:
        """Return the first angles that are all newer than `host_s`; None so far."""

    def spread_rad(self, since_s: float, until_s: float = math.inf) -> float | None:
        """Return the largest range any joint covered in a time; None if it is not known."""

    def silence_s(self, since_s: float, until_s: float) -> float:
        """Return for how long nothing was told of the arm between two times."""


class JointSource(Protocol):
    """A line, or a person, that tells joint angles."""

    name: str

    @property
    def joints(self) -> Joints:
        """What it has told so far."""

    @property
    def faults(self) -> int:
        """What came and could not be read."""

    def fileno(self) -> int:
        """Return the descriptor to wait on, or -1 where the source must be asked."""

    def collect(self, now_s: float) -> None:
        """Fetch what has come by `now_s`; never waits, and leaves the work to `hear`."""

    def hear(self) -> None:
        """Understand what was collected."""

    def take_posture(
        self, word: StatedPosture, posture: PlannedPosture | None, now_s: float
    ) -> str:
        """Take what a person says of the arm; return whether it was taken, in words."""

    def begin_posture(self) -> None:
        """Another posture is asked for: what a person said of the last one holds no longer."""

    def silence(self) -> str:
        """Say, to the operator, what is missing while joints are absent."""

    def close(self) -> None:
        """Let go; never raises."""


class MeasuredAngles(Protocol):
    """What a source does by itself that a device tells, and no person."""

    def take_posture(
        self, word: StatedPosture, posture: PlannedPosture | None, now_s: float
    ) -> str:
        """Refuse it: what is measured is not mixed with what is told."""
        del word, posture, now_s
        return "where the arm stands is measured, and was not taken from the operator"

    def begin_posture(self) -> None:
        """Do nothing: angles are measured again and again."""
        return


class CanJoints(MeasuredAngles):
    """Angles from the controller's bus."""

    def __init__(self, bus: CanSource, joints: JointState) -> None:
        self.name = bus.name
        self.joints = joints
        self._bus = bus
        self._n_frames = 0

    @property
    def faults(self) -> int:
        """What came and was no frame."""
        return self._bus.faults

    def fileno(self) -> int:
        """Return the bus's descriptor."""
        return self._bus.fileno()

    def collect(self, now_s: float) -> None:
        """Fetch what has come."""
        self._bus.collect(now_s)

    def hear(self) -> None:
        """Decode what has come; many frames at a time cost less than a few often."""
        for at_s, frames in self._bus.take():
            self._n_frames += len(frames)
            self.joints.feed(frames, at_s)

    def silence(self) -> str:
        """Say what is missing, and what may be the reason."""
        mapping, state = self.joints.mapping, self.joints
        missing = ", ".join(state.absent)
        if state.frames or state.invalid:
            return (
                f"the controller on {self.name} sends no angle of {missing} "
                f"({state.frames} frames decoded, {state.invalid} not): does the database "
                f"{mapping.database} fit this controller?"
            )
        if self._n_frames:
            return (
                f"{self._n_frames} frames came on {self.name}, none of them of "
                f"{mapping.database}: is it the right bus, and the right arm file?"
            )
        return (
            f"no frame came on {self.name} at {mapping.bitrate} bit/s: is the controller on and "
            "sending (a CiA 402 drive needs a master that sends NMT and SYNC), and is the bit rate "
            f"right? {self.faults} lines could not be read"
        )

    def close(self) -> None:
        """Let go of the bus."""
        self._bus.close()
