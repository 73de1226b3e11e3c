"""What stands on a joint's axis is on either link of that joint."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["is_on_shared_axis"]

Array = npt.NDArray[np.float64]

_ON_AXIS_M = 0.03  # inside a joint's bearing: both links move alike there


def is_on_shared_axis(ordinary: Ordinary, link: int, at_m: Array, other: str) -> bool:
    """Whether a place (3,) of a link's frame, m, is on the axis of its joint with another link.

    `other` names that link; of one that is no neighbour it is not.
    """
    joints = ordinary.arm.joints
    if link > 0 and other == joints[link - 1].link.name:
        axis, origin = np.asarray(joints[link].axis), np.zeros(3)
    elif link + 1 < len(joints) and other == joints[link + 1].link.name:
        T = joints[link + 1].T_parent_joint
        axis, origin = T[:3, :3] @ np.asarray(joints[link + 1].axis), T[:3, 3]
    else:
        return False
    return bool(np.linalg.norm(np.cross(at_m - origin, axis)) < _ON_AXIS_M)
