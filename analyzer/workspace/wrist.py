"""Where the axes of a wrist cross, or come nearest to one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["PARALLEL", "WristCentre", "axis_lines", "wrist_centre", "wrist_joints"]

Array = npt.NDArray[np.float64]

POSITIONING = 3  # joints at least that carry a wrist
WRIST_AXES = 3
PARALLEL = 1e-6  # rad between axes called parallel


@dataclass(frozen=True, slots=True, kw_only=True)
class WristCentre:
    """The point nearest to the wrist's axes in the least-squares sense.

    Attributes
    ----------
    joints
        Numbers (0-based) of the wrist's joints, the last two or three.
    point_m
        (3,) base frame, in the posture asked for.
    gap_m
        Largest distance of the point from one of the axes: zero where they cross.
    """

    joints: tuple[int, ...]
    point_m: Array
    gap_m: float

    def words(self, arm: Arm) -> str:
        """Where the centre is, and how far from the axes it is."""
        names = ", ".join(arm.joints[i].name for i in self.joints)
        if self.gap_m < 1e-4:
            return f"the wrist's centre is where the axes of {names} cross"
        return (
            f"the axes of {names} do not cross: the wrist's centre is the point nearest to them, "
            f"{1e3 * self.gap_m:.0f} mm from the farthest, with these joints where the maps hold "
            "them"
        )


def wrist_joints(arm: Arm) -> tuple[int, ...]:
    """Return the last three joints, or the two that are left behind three of five.

    Raises
    ------
    ArmError
        If the arm has fewer than five joints.
    """
    n = len(arm.joints)
    if n < POSITIONING + 2:
        raise ArmError(
            f"arm '{arm.name}' has {n} joints; maps over the wrist's position need three joints "
            "and a wrist of two or more behind them; use the statistics over random postures "
            "instead"
        )
    return tuple(range(n - min(WRIST_AXES, n - POSITIONING), n))


def axis_lines(arm: Arm, joints_rad: Array) -> tuple[Array, Array]:
    """Points (n_joints, 3) on the joints' axes and unit directions (n_joints, 3), base frame."""
    T = np.eye(4)
    points, directions = [], []
    for joint, q in zip(arm.joints, joints_rad, strict=True):
        T = T @ joint.T_parent_joint
        points.append(T[:3, 3].copy())
        directions.append(T[:3, :3] @ joint.axis)
        T[:3, :3] = T[:3, :3] @ _turn(joint.axis, float(q))
    return np.array(points), np.array(directions)


def wrist_centre(arm: Arm, joints_rad: Array) -> WristCentre:
    """Find the wrist's centre in a posture.

    The sum of squared distances from the axes is least where
    sum (1 - a aᵀ) (x - p) = 0, with points p on the axes and directions a.

    Raises
    ------
    ArmError
        If the arm has fewer than five joints, or all axes of its wrist are parallel.
    """
    joints = wrist_joints(arm)
    points, directions = (one[list(joints)] for one in axis_lines(arm, joints_rad))
    across = np.array([np.eye(3) - np.outer(a, a) for a in directions])
    total = across.sum(axis=0)
    # Of parallel axes the least eigenvalue is zero, of axes at an angle e some e²/2.
    if np.linalg.eigvalsh(total)[0] < PARALLEL**2:
        names = ", ".join(arm.joints[i].name for i in joints)
        raise ArmError(
            f"the axes of {names} of arm '{arm.name}' are parallel: they have no centre over which "
            "maps could be drawn; use the statistics over random postures instead"
        )
    point = np.linalg.solve(total, np.einsum("kij,kj->i", across, points))
    distances = np.linalg.norm(np.einsum("kij,kj->ki", across, point - points), axis=1)
    return WristCentre(joints=joints, point_m=point, gap_m=float(distances.max()))


def _turn(axis: Sequence[float] | Array, angle_rad: float) -> Array:
    """Rotation by Rodrigues' formula."""
    x, y, z = axis
    S = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + np.sin(angle_rad) * S + (1.0 - np.cos(angle_rad)) * (S @ S)
    return turn
