"""What is known of the arm around a block: its angles before and after, and on the way."""

from __future__ import annotations

from armodal.daq.blocks import CapturedBlock
from armodal.daq.clock import Clock
from armodal.daq.joint_source import Joints
from armodal.daq.joint_state import largest_difference_rad
from armodal.daq.judge_posture import judge_posture
from armodal.daq.operator_joints import allowed_deviation_rad
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.plan_records import PlannedPosture
from armodal.protocols.session.records import JointReading

__all__ = ["ArmAround"]

SILENCE_S, SILENT_CYCLES = 0.1, 4.0  # of the bus during a hit: no arm goes and returns so fast
SILENCE_WALL_S = 0.1  # the bus's process may be held up for so long
AFTER_WALL_S = 0.15  # the bus's process is given at least so long for a newer angle


class ArmAround:
    """Readings of the arm around a block, and the verdict on them.

    Parameters
    ----------
    settings
        The session's settings: arm, limits, and how long the arm must stand still.
    clock
        The session's clock.
    joints
        What is told of the arm.
    turn_s
        Longest time in seconds from a frame's coming to its reading.
    """

    def __init__(
        self, settings: AcquisitionSettings, clock: Clock, joints: Joints, turn_s: float
    ) -> None:
        self._settings = settings
        self._clock = clock
        self._joints = joints
        self._turn_s = turn_s

    def is_off(self, posture: PlannedPosture, reading: JointReading) -> bool | None:
        """Whether the arm is beyond the posture's tolerance; None where it is not known."""
        if reading.joints_rad is None:
            return None
        off_rad = largest_difference_rad(reading.joints_rad, posture.joints_rad)
        return bool(off_rad > self._allowed_rad(posture))

    def is_still(self, posture: PlannedPosture, now_s: float) -> bool:
        """Whether the arm has not moved for as long as it must stand still."""
        spread_rad = self._joints.spread_rad(now_s - self._settings.still_s)
        return spread_rad is not None and spread_rad <= self._moved_rad(posture)

    def before(self, start_s: float) -> JointReading:
        """Return angles not later than the block's first sample, at `start_s`."""
        return self._joints.reading_before(start_s)

    def after(self, block: CapturedBlock, end_s: float, now_s: float) -> JointReading | None:
        """Return angles later than the block's end at `end_s`, None while there is hope for them.

        Once there is none, the reading's joints are None.
        """
        after = self._joints.reading_after(end_s + self._turn_s)
        if after is not None:
            return after
        hope_s = max(self._settings.settle_s, AFTER_WALL_S / self._clock.wall_s(1.0))
        if now_s - max(block.last_data_s, end_s) < hope_s:
            return None
        last = self._joints.reading(now_s)
        return JointReading(
            joints_rad=None,
            drive_state=last.drive_state,
            held=last.held,
            age_s=max(last.age_s, hope_s),
            host_s=now_s,
        )

    def judged(
        self, before: JointReading, after: JointReading, posture: PlannedPosture
    ) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return reasons and notes against a hit between two readings."""
        return judge_posture(
            before,
            after,
            posture.joints_rad,
            self._allowed_rad(posture),
            self._moved_rad(posture),
            self._joints.spread_rad(before.host_s, after.host_s),
            self._silence(before, after),
        )

    def _silence(self, before: JointReading, after: JointReading) -> str:
        """Say that nothing was known of the arm for too long during a hit; empty if it was."""
        rate_hz = self._joints.rate_hz
        last_heard_s = before.host_s - before.age_s  # a silence may have begun before the hit
        silence_s = self._joints.silence_s(last_heard_s, after.host_s)
        if rate_hz is None:
            return ""
        floor_s = SILENCE_WALL_S / self._clock.wall_s(1.0)
        if silence_s <= max(SILENCE_S, SILENT_CYCLES / rate_hz, floor_s):
            return ""
        return f"no joint angles for {silence_s:.3g} s during the hit"

    def _allowed_rad(self, posture: PlannedPosture) -> float:
        """Largest distance from the posture: what is told by hand may be off by its tolerance."""
        told_rad = self._settings.told_tolerance_rad
        return (
            posture.tolerance_rad
            if told_rad is None
            else allowed_deviation_rad(posture.tolerance_rad, told_rad)
        )

    def _moved_rad(self, posture: PlannedPosture) -> float:
        return self._settings.limits.moved * posture.tolerance_rad
