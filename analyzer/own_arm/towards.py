"""The place that a test point is moved towards: another point of its link, or a joint's axis."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.files import BASE
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.errors import ArmError

__all__ = ["joints_of_link", "point_named", "step_towards"]

Array = npt.NDArray[np.float64]
_NUMBERED = re.compile(r"J([1-9][0-9]?)", re.IGNORECASE)


def joints_of_link(arm: Arm, link: str) -> dict[str, tuple[Array, Array]]:
    """The joints at the ends of a link, base side first.

    Returns
    -------
    dict
        By name: a place on the axis (3,), m, and the axis (3,), both in the link's frame.
    """
    found = {}
    parent = BASE
    for joint in arm.joints:
        if joint.link.name == link:
            found[joint.name] = (np.zeros(3), joint.axis)
        if parent == link:
            T = joint.T_parent_joint
            found[joint.name] = (T[:3, 3], T[:3, :3] @ joint.axis)
        parent = joint.link.name
    return found


def point_named(arm: Arm, point: Point, name: str) -> Array:
    """(3,) where another point of a point's link lies, m.

    Raises
    ------
    ArmError
        If the link has no such point.
    """
    others = _others(arm, point)
    if name not in others:
        ids = ", ".join(others) or "it has none"
        raise ArmError(f"wanted another point of link {point.link}: {ids}; got {name!r}")
    return others[name]


def step_towards(arm: Arm, point: Point, name: str, length_m: float) -> Array:
    """(3,) the way of a length towards what is named, in the link's frame, m.

    Parameters
    ----------
    name
        Another point of the link; or a joint at one of the link's ends, by its name or as J3: the
        place on its axis that is nearest to the point.

    Raises
    ------
    ArmError
        If it is neither, or the point lies there already.
    """
    others, joints = _others(arm, point), joints_of_link(arm, point.link)
    numbered = _NUMBERED.fullmatch(name)
    called = name
    if numbered and name not in others and int(numbered[1]) <= len(arm.joints):
        called = arm.joints[int(numbered[1]) - 1].name
    if called in others:
        place = others[called]
    elif called in joints:
        origin, axis = joints[called]
        place = origin + axis * float(axis @ (point.position_m - origin))
    else:
        raise ArmError(
            f"wanted another point of link {point.link} ({', '.join(others) or 'it has none'}) or "
            f"a joint at its ends ({', '.join(joints)}); got {name!r}"
        )
    way = place - point.position_m
    distance = float(np.linalg.norm(way))
    if distance == 0.0:
        raise ArmError(f"point {point.id} lies at {name} already")
    return np.asarray(way * (length_m / distance))


def _others(arm: Arm, point: Point) -> dict[str, Array]:
    return {p.id: p.position_m for p in arm.points if p.link == point.link and p.id != point.id}
