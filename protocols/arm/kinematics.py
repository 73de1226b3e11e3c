"""Poses of an arm's links: the chain of joints, nothing more."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm

__all__ = ["link_pose"]


def link_pose(arm: Arm, link: str, joints_rad: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return T_base_link, (4, 4) in m, of a link's frame; KeyError for an unknown link.

    Parameters
    ----------
    arm
        The arm.
    link
        Name of a link, or "base".
    joints_rad
        (n_joints,) joint angles.
    """
    T = np.eye(4)
    if link == "base":
        return T
    angles = np.asarray(joints_rad, dtype=np.float64)
    for joint, angle in zip(arm.joints, angles, strict=True):
        turn = np.eye(4)
        turn[:3, :3] = _rotation(joint.axis, float(angle))
        T = T @ joint.T_parent_joint @ turn
        if joint.link.name == link:
            return T
    raise KeyError(link)


def _rotation(axis: npt.NDArray[np.float64], angle_rad: float) -> npt.NDArray[np.float64]:
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: npt.NDArray[np.float64] = (
        np.eye(3) + np.sin(angle_rad) * K + (1.0 - np.cos(angle_rad)) * (K @ K)
    )
    return rotation
