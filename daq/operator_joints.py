"""Joint angles by hand: a person says where the arm stands, and that it is held.

What was said holds for one posture, until the next one is begun. Nobody watches the arm meanwhile:
that it has not moved is the person's word too, and every result says so.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from armodal.daq.commands import StatedPosture
from armodal.protocols.arrays import frozen_array
from armodal.protocols.plan_records import PlannedPosture
from armodal.protocols.session.records import JointReading

__all__ = ["OperatorJoints", "OperatorSource", "allowed_deviation_rad", "posture_refusal"]

ROUNDING_RAD = 1e-9  # of degrees to radians and back


class OperatorJoints:
    """What a person has said of the posture in hand."""

    frames = 0
    lost = 0
    invalid = 0
    absent: tuple[str, ...] = ()  # a person is not waited for at the start
    rate_hz: float | None = None

    def __init__(self) -> None:
        self._told: JointReading | None = None

    def tell(self, joints_rad: npt.NDArray[np.float64], now_s: float) -> None:
        """Take a person's word: the arm stands so, (n_joints,) rad, and is held."""
        self._told = JointReading(
            joints_rad=frozen_array(joints_rad, np.float64),
            drive_state=None,
            held=True,
            age_s=0.0,
            host_s=now_s,
        )

    def forget(self) -> None:
        """Another posture is asked for: what was said holds no longer."""
        self._told = None

    def reading(self, now_s: float) -> JointReading:
        """Return what was said, with the time since then as its age."""
        told = self._told
        if told is None or told.host_s > now_s:
            return JointReading(
                joints_rad=None, drive_state=None, held=False, age_s=math.inf, host_s=now_s
            )
        return JointReading(
            joints_rad=told.joints_rad,
            drive_state=None,
            held=told.held,
            age_s=now_s - told.host_s,
            host_s=now_s,
        )

    def reading_before(self, host_s: float) -> JointReading:
        """Return what had been said by then."""
        return self.reading(host_s)

    def reading_after(self, host_s: float) -> JointReading | None:
        """Return what was said: nothing newer will come."""
        return self.reading(host_s)

    def spread_rad(self, since_s: float, until_s: float = math.inf) -> float | None:
        """Return 0 once something was said: the person's word is that the arm is held."""
        del since_s, until_s
        return None if self._told is None else 0.0

    def silence_s(self, since_s: float, until_s: float) -> float:
        """Return 0: no more is expected."""
        del since_s, until_s
        return 0.0


def allowed_deviation_rad(tolerance_rad: float, told_rad: float) -> float:
    """Return how far from a posture an angle told to `told_rad` may be, so that it is surely there.

    Two equal tolerances leave room for rounding, and no more.
    """
    return max(tolerance_rad - told_rad, 0.0) + ROUNDING_RAD


def posture_refusal(word: StatedPosture, posture: PlannedPosture, told_rad: float) -> str:
    """Return why angles told to `told_rad` are not those of a posture; empty where they are."""
    if word.joints_rad is None:
        return ""
    joints_rad, planned_rad = np.array(word.joints_rad), posture.joints_rad
    if joints_rad.shape != planned_rad.shape or not np.isfinite(joints_rad).all():
        return f"wanted {planned_rad.size} joint angles, got {joints_rad.size}; tell them all"
    off_rad = np.abs(joints_rad - planned_rad)
    allowed_rad = allowed_deviation_rad(posture.tolerance_rad, told_rad)
    joint = int(off_rad.argmax())
    if off_rad[joint] <= allowed_rad:
        return ""
    return (
        f"joint {joint + 1} was given {math.degrees(off_rad[joint]):.2f} deg off posture "
        f"{posture.name}, {math.degrees(allowed_rad):.2f} allowed with angles read to "
        f"{math.degrees(told_rad):g} deg; bring the arm nearer"
    )


class OperatorSource:
    """The person as a source; there is no line.

    Parameters
    ----------
    tolerance_rad
        To how much the person reads the angles, as he has stated.
    """

    name = "the operator"
    faults = 0

    def __init__(self, tolerance_rad: float) -> None:
        self.joints = OperatorJoints()
        self._tolerance_rad = tolerance_rad

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on."""
        return -1

    def collect(self, now_s: float) -> None:
        """Do nothing: what the person says comes as a command."""

    def hear(self) -> None:
        """Do nothing."""

    def take_posture(
        self, word: StatedPosture, posture: PlannedPosture | None, now_s: float
    ) -> str:
        """Take the angles, if the arm is at the posture with all they may be off."""
        if posture is None:
            return "joint angles were given when no posture was asked for: not taken"
        refused = posture_refusal(word, posture, self._tolerance_rad)
        if refused:
            return f"{refused}: not taken"
        planned_rad = posture.joints_rad
        joints_rad = planned_rad if word.joints_rad is None else np.array(word.joints_rad)
        self.joints.tell(joints_rad, now_s)
        degrees = " ".join(f"{x + 0.0:.2f}" for x in np.degrees(joints_rad))
        return (
            f"told by the operator: the arm is at {posture.name}, {degrees} deg to "
            f"{math.degrees(self._tolerance_rad):g} deg, and held"
        )

    def begin_posture(self) -> None:
        """Forget what was said of the posture before."""
        self.joints.forget()

    def silence(self) -> str:
        """Say that nothing was said."""
        return "the operator has not said where the arm stands"

    def close(self) -> None:
        """Do nothing."""
