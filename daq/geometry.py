"""Directions at a posture: just enough kinematics to say where a planned hit points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from protocols.arm.records import Arm
from protocols.arrays import frozen_array
from protocols.plan_records import PlannedPosture

__all__ = ["hit_direction", "link_rotation"]


def link_rotation(
    arm: Arm, link: str, joints_rad: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the (3, 3) rotation of a link's frame in base; KeyError for an unknown link."""
    R = np.eye(3)
    if link == "base":
        return R
    for joint, angle in zip(arm.joints, joints_rad, strict=True):
        R = R @ joint.T_parent_joint[:3, :3] @ _rotation(joint.axis, float(angle))
        if joint.link.name == link:
            return R
    raise KeyError(link)


def hit_direction(arm: Arm, posture: PlannedPosture, hit_point: str) -> npt.NDArray[np.float64]:
    """Return the (3,) unit direction of the force in base: as planned, or into the surface."""
    if posture.hit_direction is not None:
        return posture.hit_direction
    point = arm.point(hit_point)
    normal = link_rotation(arm, point.link, posture.joints_rad) @ point.R_link_sensor[:, 2]
    return frozen_array(-normal / np.linalg.norm(normal), np.float64)


def _rotation(axis: npt.NDArray[np.float64], angle_rad: float) -> npt.NDArray[np.float64]:
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: npt.NDArray[np.float64] = (
        np.eye(3) + np.sin(angle_rad) * K + (1.0 - np.cos(angle_rad)) * (K @ K)
    )
    return rotation
