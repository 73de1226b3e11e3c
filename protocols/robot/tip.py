"""Where an arm ends and its tool begins: the last link that belongs to the arm."""

from __future__ import annotations

import re

from armodal.protocols.robot.records import MOVING, Robot, RobotJoint
from armodal.protocols.robot.remarks import Remarks, few
from armodal.protocols.robot.tree import joints_below, path_to

__all__ = ["found_tip"]

# How makers and ROS-Industrial (REP 199) name what ends an arm and begins a tool.
_TIP = re.compile(
    r"(^|_)(tool0?|flange|link_eef|ee_link|tool_link|tcp|link_ee|end_effector|hand|attachment_site)$"
)
_FINGER_JOINT = re.compile(r"finger|grip|knuckle|jaw|claw|thumb", re.IGNORECASE)
_FINGER_LINK = re.compile(r"finger|knuckle|jaw|claw|thumb", re.IGNORECASE)


def found_tip(robot: Robot, root: str, said: Remarks) -> str | None:
    """The link named as one, else the end of the longest chain short of fingers."""
    ends: dict[str, int] = {}
    for name in robot.links:
        path = path_to(robot, root, name)
        # A tool's own joints come after the tip.
        if any(joint.kind != "fixed" and _is_finger(robot, joint) for joint in path):
            continue
        ends[name] = sum(joint.kind in MOVING and not joint.mimics for joint in path)
    most = max(ends.values(), default=0)
    if most == 0:
        said.fault("joints", "wanted a chain with revolute joints, found none")
        return None
    last = [name for name, count in ends.items() if count == most]
    firsts = {_last_moving(robot, root, name) for name in last}
    if len(firsts) > 1:
        shared = _shared(robot, root, firsts)
        if 2 * len(shared) <= most:
            said.fault(
                "tip",
                f"wanted one arm, found {len(firsts)} chains of {most} moving joints; "
                f"give --tip, one of {few(sorted(firsts))}",
            )
            return None
        # What parts behind the greater part of the joints is a gripper, however it is named.
        carrier = shared[-1].child
        said.note("tip", f"chains part behind link {carrier}: taken for fingers, and held")
        below = {carrier} | {joint.child for joint in joints_below(robot, carrier)}
        last = [name for name, count in ends.items() if name in below and count == len(shared)]
        firsts = {carrier}
    named = [name for name in last if _TIP.search(name)]
    # Frames fixed to one another: the first that is named as a tip, else the moving link itself.
    return min(named, key=lambda name: len(path_to(robot, root, name))) if named else firsts.pop()


def _is_finger(robot: Robot, joint: RobotJoint) -> bool:
    """Whether a joint is named as a finger's, or is the last and drives another beside it."""
    if _FINGER_JOINT.search(joint.name) or _FINGER_LINK.search(joint.child):
        return True
    behind = [other for other in joints_below(robot, joint.child) if other.kind in MOVING]
    carrier = _carrier(robot, joint.parent)
    return all(other.mimics for other in behind) and any(
        other.mimics == joint.name and _carrier(robot, other.parent) == carrier
        for other in robot.joints
    )


def _carrier(robot: Robot, link: str) -> str:
    """The link that carries a link fast: itself, or the first one inwards that moves."""
    by_child = {joint.child: joint for joint in robot.joints}
    seen = {link}
    while link in by_child and by_child[link].kind == "fixed" and by_child[link].parent not in seen:
        link = by_child[link].parent
        seen.add(link)
    return link


def _shared(robot: Robot, root: str, ends: set[str]) -> list[RobotJoint]:
    """The moving joints that the chains to several links have in common, from the root on."""
    paths = [
        [joint for joint in path_to(robot, root, end) if joint.kind in MOVING and not joint.mimics]
        for end in sorted(ends)
    ]
    shared = []
    for joints in zip(*paths, strict=False):
        if len({joint.name for joint in joints}) > 1:
            break
        shared.append(joints[0])
    return shared


def _last_moving(robot: Robot, root: str, link: str) -> str:
    return next(
        joint.child
        for joint in reversed(path_to(robot, root, link))
        if joint.kind in MOVING and not joint.mimics
    )
