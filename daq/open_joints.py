"""Open the source of joint angles that a session was started with, and hear of every joint."""

from __future__ import annotations

import math

from armodal.daq.can_listener import CanSource, check_hears
from armodal.daq.clock import Clock
from armodal.daq.controller import without_bus_options
from armodal.daq.joint_source import CanJoints, JointSource
from armodal.daq.joint_state import JointState
from armodal.daq.operator_joints import OperatorSource
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.surroundings import Surroundings
from armodal.protocols.arm.records import Arm, CanMapping
from armodal.protocols.errors import ArmError, CanError, PlanError
from armodal.protocols.plan_records import Plan

__all__ = ["can_joints", "can_mapping", "check_told", "hear_every_joint", "open_joints"]

CAN_WALL_S = 1.0  # the controller is given at least so long at the start
IDLE_WALL_S = 0.02


def open_joints(settings: AcquisitionSettings, surroundings: Surroundings) -> JointSource:
    """Open the source of joint angles.

    Raises
    ------
    ArmError, PlanError, CanError, ControllerError, PortError, DeviceTimeoutError, DeviceLostError,
    MissingPackageError
        If the arm or the plan does not go with it, or it cannot be opened.
    """
    if settings.told_tolerance_rad is not None:
        check_told(settings.plan, settings.told_tolerance_rad)
        return OperatorSource(settings.told_tolerance_rad)
    if settings.controller is not None:
        return settings.controller.open(settings.arm)
    mapping = can_mapping(settings.arm)
    check_hears(settings.can_channel, mapping)
    return can_joints(surroundings.open_can(settings, mapping.bitrate), mapping, settings.arm)


def can_mapping(arm: Arm) -> CanMapping:
    """Return where the arm's angles are on the bus; ArmError where its file does not say it."""
    if arm.can is None:
        raise ArmError(
            f"arm {arm.name} has no [can] section: wanted one that says where the joint angles are "
            f"in the controller's frames; without a bus, give {without_bus_options()}"
        )
    return arm.can


def can_joints(bus: CanSource, mapping: CanMapping, arm: Arm) -> CanJoints:
    """Return the angles of a bus that is open."""
    return CanJoints(bus, JointState(mapping, [joint.name for joint in arm.joints]))


def check_told(plan: Plan, tolerance_rad: float) -> None:
    """Refuse a tolerance with which nobody could tell that the arm is at its postures.

    Raises
    ------
    PlanError
        If a posture is to be kept more closely than the angles are told.
    """
    close = [p for p in plan.postures if p.tolerance_rad < tolerance_rad]
    if close:
        wanted = ", ".join(f"{p.name} {math.degrees(p.tolerance_rad):g}" for p in close)
        raise PlanError(
            f"plan {plan.name}: its tolerance_deg ({wanted}) is closer than the "
            f"{math.degrees(tolerance_rad):g} deg to which joint angles are read by hand: read "
            "them more closely, or let the plan's postures have a larger tolerance_deg"
        )


def hear_every_joint(source: JointSource, clock: Clock, timeout_s: float) -> None:
    """Wait until every joint has been heard of.

    Raises
    ------
    CanError
        If one is not, after `timeout_s` lab seconds; it says what is missing.
    """
    until_s = clock.now_s() + max(timeout_s, CAN_WALL_S / clock.wall_s(1.0))
    while source.joints.absent:
        left_s = until_s - clock.now_s()
        if left_s <= 0.0:
            raise CanError(source.silence())
        if source.fileno() < 0:
            clock.sleep(min(left_s, IDLE_WALL_S / clock.wall_s(1.0)))
        else:
            clock.wait([source.fileno()], clock.wall_s(left_s))
        source.collect(clock.now_s())
        source.hear()
