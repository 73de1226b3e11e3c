"""Cartesian stiffness of the tool along a path, or over the plane the arm reaches into.

With K the springs and J the tool's motion by each of them, the tool gives way by C f with
C = J K^-1 J' (file 001, Eq. (1)); gravity's small stiffness is left out, as there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.corrected.batch import BatchedArm
from armodal.analyzer.workspace.meridian import ELBOWS, meridian_plane
from armodal.protocols.errors import ArmError

__all__ = ["PlaneStiffness", "ToolStiffness", "stiffness_in_plane", "tool_stiffness"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolStiffness:
    """Of n postures under one force at the tool; base frame."""

    joints_rad: Array  # (n, n_joints)
    tool_m: Array  # (n, 3)
    compliance_m_per_n: Array  # (n, 3, 3) of the tool point, no moment at it
    displacement_m: Array  # (n, 3)
    along_n_per_m: Array  # (n,) force over the displacement along it
    softest_n_per_m: Array  # (n,) in the direction that gives way most
    axis_distance_m: Array  # (n,) from the tool to its Mozzi axis; inf for a translation

    @property
    def best(self) -> int:
        """Return the posture that gives way least along the force."""
        return int(np.argmax(self.along_n_per_m))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneStiffness:
    """Over a grid of the wrist's places in the meridian plane, the stiffer of both elbows."""

    horizontal_m: Array  # (n_h,)
    vertical_m: Array  # (n_v,)
    along_n_per_m: Array  # (n_v, n_h), NaN out of reach
    elbow: npt.NDArray[np.int64]  # (n_v, n_h) 0: up, 1: down, -1: out of reach
    joints_rad: Array  # (n_v, n_h, n_joints)
    best: ToolStiffness  # of the stiffest place


def tool_stiffness(
    ready: BatchedArm, joints_rad: Array, force_n: npt.ArrayLike, *, tool_m: npt.ArrayLike
) -> ToolStiffness:
    """Evaluate postures (n, n_joints) under a force (3,) in N, base axes.

    Raises
    ------
    ArmError
        If the force is none.
    """
    force = np.asarray(force_n, dtype=np.float64)
    size = float(np.linalg.norm(force))
    if not size > 0.0:
        raise ArmError("wanted a force, got none; give --force in N, such as 0,0,-100")
    every, tool = ready.batch.unit_motions(joints_rad, tool_m)
    J = np.moveaxis(every[:, list(ready.elastic.joints)], 2, 0)  # (n, 6, n_elastic)
    flexibility = ready.elastic.yields(np.eye(J.shape[2]))
    C = J @ flexibility @ J.swapaxes(1, 2)
    motion = C[:, :, :3] @ force
    along = motion[:, :3] @ force / size
    spin = motion[:, 3:]
    speed = np.linalg.norm(spin, axis=1)
    across = np.linalg.norm(np.cross(spin, motion[:, :3]), axis=1)
    with np.errstate(divide="ignore"):
        stiffness = np.where(along > 0.0, size / np.where(along > 0.0, along, 1.0), np.inf)
        softest = 1.0 / np.linalg.eigvalsh(C[:, :3, :3])[:, -1]
    distance = np.divide(across, speed**2, out=np.full_like(speed, np.inf), where=speed > 0)
    return ToolStiffness(
        joints_rad=np.asarray(joints_rad, dtype=np.float64),
        tool_m=tool.T,
        compliance_m_per_n=C[:, :3, :3],
        displacement_m=motion[:, :3],
        along_n_per_m=stiffness,
        softest_n_per_m=np.asarray(softest, dtype=np.float64),
        axis_distance_m=distance,
    )


def stiffness_in_plane(
    ready: BatchedArm, force_n: npt.ArrayLike, *, tool_m: npt.ArrayLike, n_lines: int
) -> PlaneStiffness:
    """Evaluate the wrist's places in the meridian plane, joints 1 and 4 on at zero.

    Parameters
    ----------
    n_lines
        Grid lines each way over the square that holds the wrist's reach.

    Raises
    ------
    ArmError
        If the arm has no meridian plane, or the force is none.
    """
    plane = meridian_plane(ready.batch.arm)
    sides = np.linspace(-plane.reach_m, plane.reach_m, n_lines)
    horizontal, vertical = sides + plane.shoulder_m.real, sides + plane.shoulder_m.imag
    grid = np.meshgrid(horizontal, vertical)
    low, high = np.array([joint.range_rad for joint in ready.batch.arm.joints]).T
    q = np.stack([plane.joints(*grid, elbow) for elbow in ELBOWS])
    reached = ~np.isnan(q).any(axis=-1)
    reached &= ((q >= low) & (q <= high) | np.isnan(q)).all(axis=-1)
    found = tool_stiffness(ready, q[reached], force_n, tool_m=tool_m)
    along = np.full(reached.shape, -np.inf)
    along[reached] = found.along_n_per_m
    elbow = np.argmax(along, axis=0)
    best = np.take_along_axis(along, elbow[None], axis=0)[0]
    nowhere = ~reached.any(axis=0)
    return PlaneStiffness(
        horizontal_m=horizontal,
        vertical_m=vertical,
        along_n_per_m=np.where(nowhere, np.nan, best),
        elbow=np.where(nowhere, -1, elbow),
        joints_rad=np.take_along_axis(q, elbow[None, ..., None], axis=0)[0],
        best=tool_stiffness(ready, found.joints_rad[found.best][None], force_n, tool_m=tool_m),
    )
