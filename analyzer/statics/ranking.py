"""Postures ranked for a machining force: how far the tool gives, and how near its axis passes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.statics.deflection import deflect
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints

__all__ = ["RankedPostures", "rank_postures"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class RankedPostures:
    """Postures, the one whose tool gives least first."""

    joints_rad: Array  # (n, n_joints)
    tool_m: Array  # (n, 3), base
    displacement_m: Array  # (n,) size of the tool's motion
    into_surface_m: Array  # (n,) along the surface's normal, signed
    axis_distance_m: Array  # (n,) from the tool point to the Mozzi axis; inf for a translation


def rank_postures(
    batch: ArmBatch,
    elastic: ElasticJoints,
    joints_rad: npt.ArrayLike,
    wrench: npt.ArrayLike,
    surface_normal: npt.ArrayLike,
    *,
    tool_m: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> RankedPostures:
    """Rank postures by the tool's displacement under a force at the work surface.

    Parameters
    ----------
    joints_rad
        (n_postures, n_joints), such as random postures within reach.
    wrench
        (6,) at the tool point, base frame.
    surface_normal
        (3,) of the work surface through the tool point, base frame, out of the work.

    References
    ----------
    File 001, section 3: a posture is good whose Mozzi axis lies so that the tool's motion neither
    digs in nor gives way.
    """
    normal = np.asarray(surface_normal, dtype=np.float64)
    normal = normal / np.linalg.norm(normal)
    found = deflect(batch, elastic, joints_rad, wrench, tool_m=tool_m)
    speed = np.linalg.norm(found.rotation_rad, axis=1)
    across = np.linalg.norm(np.cross(found.rotation_rad, found.displacement_m), axis=1)
    # The part of the motion at right angles to the axis, over the rotation, is the distance.
    distance = np.divide(across, speed**2, out=np.full_like(speed, np.inf), where=speed > 0)
    size = np.linalg.norm(found.displacement_m, axis=1)
    order = np.argsort(size, kind="stable")
    return RankedPostures(
        joints_rad=np.asarray(joints_rad, dtype=np.float64)[order],
        tool_m=found.tool_m[order],
        displacement_m=size[order],
        into_surface_m=-(found.displacement_m @ normal)[order],
        axis_distance_m=distance[order],
    )
