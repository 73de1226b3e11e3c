"""Directions at a posture: just enough kinematics to say where a planned hit points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.protocols.plan_records import PlannedPosture

__all__ = ["hit_direction", "link_rotation"]


def link_rotation(
    arm: Arm, link: str, joints_rad: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the (3, 3) rotation of a link's frame in base; KeyError for an unknown link."""
    return link_pose(arm, link, joints_rad)[:3, :3]


def hit_direction(arm: Arm, posture: PlannedPosture, hit_point: str) -> npt.NDArray[np.float64]:
    """Return the (3,) unit direction of the force in base: as planned, or into the surface."""
    if posture.hit_direction is not None:
        return posture.hit_direction
    point = arm.point(hit_point)
    normal = link_rotation(arm, point.link, posture.joints_rad) @ point.R_link_sensor[:, 2]
    return frozen_array(-normal / np.linalg.norm(normal), np.float64)
