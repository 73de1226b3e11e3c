"""The floor, wall or ceiling below an arm's base, as a box to stay out of."""

from __future__ import annotations

import numpy as np

from armodal.protocols.arm.records import Arm, KeepOut

__all__ = ["floor_below", "reach_of"]

_REACHES = 2.0  # of the arm's own reach, each way


def reach_of(arm: Arm) -> float:
    """Sum of the distances from joint to joint, m."""
    return float(sum(np.linalg.norm(joint.T_parent_joint[:3, 3]) for joint in arm.joints))


def floor_below(reach_m: float, height_m: float) -> KeepOut:
    """All below a height in the base's frame that an arm could reach."""
    wide = _REACHES * reach_m + 0.5
    return KeepOut(
        name="floor",
        low_m=np.array([-wide, -wide, height_m - wide]),
        high_m=np.array([wide, wide, height_m]),
    )
