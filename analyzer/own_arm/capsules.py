"""Capsules between joints, for links of which nothing is drawn."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.own_arm.meshes import shape_triangles
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.robot.chain import Body
from armodal.protocols.robot.records import Shape

__all__ = ["RADIUS_OF_REACH", "capsule_between"]

# Of the distance from the first to the last joint: UR5 (radius 0.06 m of 1.0 m) to RX160 (0.2 of
# 1.7 m), from the meshes of `bench/bench_own_arm.py`'s arms.
RADIUS_OF_REACH = 0.07


def capsule_between(follower: Body | None, reach_m: float) -> Surface:
    """A capsule from a body's own joint to the next one, in the body's frame.

    Parameters
    ----------
    follower
        The body that the next joint moves; None behind the last joint, where a ball stands.
    """
    end = np.zeros(3) if follower is None else follower.T_parent_joint[:3, 3]
    length = float(np.linalg.norm(end))
    T = np.eye(4)
    if length > 1e-9:
        z = end / length
        x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
        x /= np.linalg.norm(x)
        T[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    T[:3, 3] = 0.5 * end
    radius = RADIUS_OF_REACH * reach_m * (1.0 if follower is not None else 0.5)
    shape = Shape(kind="capsule", size_m=(radius, max(length, 1e-6)), T_link_shape=T)
    return Surface(*shape_triangles(shape))
