"""Ways through the tree of a robot's links."""

from __future__ import annotations

from collections.abc import Iterator

from armodal.protocols.robot.records import Robot, RobotJoint

__all__ = ["joints_below", "path_to"]


def path_to(robot: Robot, root: str, link: str) -> list[RobotJoint]:
    """The joints from the root to a link."""
    by_child = {joint.child: joint for joint in robot.joints}
    path: list[RobotJoint] = []
    while link != root and link in by_child and len(path) <= len(robot.links):
        path.append(by_child[link])
        link = by_child[link].parent
    return path[::-1]


def joints_below(robot: Robot, link: str) -> Iterator[RobotJoint]:
    """Every joint that a link carries, near ones first."""
    waiting, seen = [link], {link}
    while waiting:
        for joint in robot.children(waiting.pop()):
            if joint.child not in seen:
                seen.add(joint.child)
                waiting.append(joint.child)
                yield joint
