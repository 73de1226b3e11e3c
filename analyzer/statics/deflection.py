"""Deflection of the tool under a load, in many postures at once, and what makes it.

The load at the tool twists every elastic joint by its share of K⁻¹ Jᵀ F, and the tool moves by
J K⁻¹ Jᵀ F (file 001, Eq. 1). The tool, with every rigid joint before it, is one rigid body whose
small motion has a Mozzi axis (file 001, section 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.screws import MozziAxis, Translation, line_angle_rad, mozzi_axis
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.protocols.errors import ArmError

__all__ = ["Deflections", "JointLine", "deflect", "joint_lines"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Deflections:
    """Deflection in n postures under one wrench at the tool; base frame."""

    names: tuple[str, ...]  # (n_elastic,) joints, then what effects let give way
    tool_m: Array  # (n, 3) the loaded point
    joint_rotation_rad: Array  # (n, n_elastic)
    displacement_m: Array  # (n, 3) of the loaded point
    rotation_rad: Array  # (n, 3) of the tool
    # Of the displacement along its own direction, by joint; sums to one, NaN where nothing moves.
    joint_share: Array  # (n, n_elastic)

    def mozzi(self, posture: int = 0) -> MozziAxis | Translation | None:
        """Mozzi axis of the tool in one posture; None where the load moves nothing."""
        rotation, displacement = self.rotation_rad[posture], self.displacement_m[posture]
        if not rotation.any() and not displacement.any():
            return None
        at_origin = displacement - np.cross(rotation, self.tool_m[posture])
        return mozzi_axis(np.concatenate([at_origin, rotation]))


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLine:
    """How a line lies to a joint's axis."""

    joint: str
    angle_deg: float  # between the two lines, 0 to 90
    distance_m: float  # shortest between the two lines


def deflect(
    batch: ArmBatch,
    elastic: ElasticJoints,
    joints_rad: npt.ArrayLike,
    wrench: npt.ArrayLike,
    *,
    tool_m: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> Deflections:
    """Deflection of the tool under a wrench.

    Parameters
    ----------
    joints_rad
        (n_postures, n_joints).
    wrench
        (6,) force in N, then moment in N m about the tool point; base frame.
    tool_m
        (3,) the loaded point in the last link's frame.

    Raises
    ------
    ArmError
        If the wrench is not six finite numbers.

    References
    ----------
    File 001, Eq. (1). The stiffness of gravity, a few parts in a thousand of the springs', is
    left out, as there.
    """
    load = np.asarray(wrench, dtype=np.float64)
    if load.shape != (6,) or not np.isfinite(load).all():
        raise ArmError(
            "wanted a wrench of six finite numbers, force x y z in N and moment x y z in N m, "
            f"got {np.asarray(wrench).tolist()}"
        )
    every, tool = batch.unit_motions(joints_rad, tool_m)
    J = every[:, list(elastic.joints)]
    rotation = elastic.yields(np.einsum("ijn,i->jn", J, load))
    parts = J * rotation  # (6, n_elastic, n)
    motion = parts.sum(axis=1)
    along = np.einsum("ijn,in->jn", parts[:3], motion[:3])
    square = (motion[:3] ** 2).sum(axis=0)
    share = np.divide(along, square, out=np.full_like(along, np.nan), where=square > 0)
    return Deflections(
        names=elastic.names(batch.arm),
        tool_m=tool.T,
        joint_rotation_rad=rotation.T,
        displacement_m=motion[:3].T,
        rotation_rad=motion[3:].T,
        joint_share=share.T,
    )


def joint_lines(
    batch: ArmBatch, joints_rad: npt.ArrayLike, axis: MozziAxis
) -> tuple[JointLine, ...]:
    """How a Mozzi axis lies to every joint's axis in one posture, (n_joints,) angles."""
    origin, direction = batch.joint_axes(np.asarray(joints_rad, dtype=float)[None])
    lines = []
    for i, joint in enumerate(batch.arm.joints):
        u, p = direction[i, :, 0], origin[i, :, 0]
        normal = np.cross(u, axis.direction)
        length = float(np.linalg.norm(normal))
        between = axis.point_m - p
        if length > 1e-9:  # below that the lines are parallel to rounding
            distance = abs(float(between @ normal)) / length
        else:
            distance = float(np.linalg.norm(np.cross(between, u)))
        angle = float(np.rad2deg(line_angle_rad(u, axis.direction)))
        lines.append(JointLine(joint=joint.name, angle_deg=angle, distance_m=distance))
    return tuple(lines)
