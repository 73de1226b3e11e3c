"""Structural modes: the share of a shape that joints explain, and the Mozzi axis of the rest.

References
----------
File 000, sections 3 to 5. The Mozzi axis of a mode is not the compliance axis where a joint
moves in the same mode; `docs/theory-identification.md` shows the bias.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.structure import Axis
from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.triplets import TripletAxes, triplet_axes
from armodal.analyzer.screws import MozziAxis, mozzi_axis, rigid_motion
from armodal.protocols.errors import EstimateError

__all__ = [
    "STRUCTURAL_SHARE",
    "joint_share",
    "moment_about",
    "mozzi_of_shape",
    "to_link",
    "triplets_of_shape",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

STRUCTURAL_SHARE = 0.9  # below this the joints do not explain the shape


def joint_share(superset: Superset, measured: MeasuredModes, shape: ComplexArray) -> float:
    """Share of a shape's squared motion that rotations of the arm's joints can make."""
    columns = [superset.joint_column(i) for i in range(superset.n_joints)]
    rows = measured.rows(measured.dynamics.point_jacobian[:, :, columns])
    solution, *_ = np.linalg.lstsq(rows.astype(np.complex128), shape, rcond=1e-6)
    rest = shape - rows @ solution
    return 1.0 - float(np.vdot(rest, rest).real / np.vdot(shape, shape).real)


def mozzi_of_shape(
    superset: Superset, measured: MeasuredModes, shape: ComplexArray, link: int
) -> MozziAxis | None:
    """Mozzi axis, in base, of all points on a link and beyond.

    None for a pure translation, and where the points are too few or in line to tell a motion.
    """
    links = np.array(superset.point_link)[measured.index]
    chosen = links >= link
    moving = shape[chosen]
    phase = np.exp(-0.5j * np.angle(np.sum(moving**2)))
    try:
        fit = rigid_motion(
            measured.dynamics.point_position[measured.index][chosen],
            measured.directions[chosen],
            moving * phase,
        )
    except EstimateError:
        return None
    axis = mozzi_axis(fit.twist.real)
    return axis if isinstance(axis, MozziAxis) else None


def triplets_of_shape(
    superset: Superset, measured: MeasuredModes, shape: ComplexArray, link: int
) -> TripletAxes | None:
    """Mozzi axes, in base, of triplets of the triaxial points on a link and beyond."""
    links = np.array(superset.point_link)[measured.index]
    points, motion = [], []
    for point in np.unique(measured.index[links >= link]):
        rows = measured.index == point
        directions = measured.directions[rows]
        if rows.sum() != 3 or abs(np.linalg.det(directions)) < 0.1:
            continue  # not triaxial
        points.append(measured.dynamics.point_position[point])
        motion.append(np.linalg.solve(directions, shape[rows]))
    if len(points) < 3:
        return None
    return triplet_axes(np.array(points), np.array(motion))


def to_link(dynamics: PostureDynamics, link: int, axis: MozziAxis) -> tuple[Array, Array]:
    """Direction and nearest point of a base-frame line in a link's frame."""
    T = dynamics.T_base_link[link]
    direction = T[:3, :3].T @ axis.direction
    point = T[:3, :3].T @ (axis.point_m - T[:3, 3])
    return direction, point - direction * (direction @ point)


def moment_about(superset: Superset, dynamics: PostureDynamics, axis: Axis) -> float:
    """Moment of inertia in kg m² of a link and all beyond it about an axis at its root."""
    columns = superset.interface_columns(axis.link)
    twist = axis.twist()
    return float(twist @ dynamics.mass[columns, columns] @ twist)
