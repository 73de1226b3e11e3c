"""Motion of any place on the arm that goes with a measured shape, for pictures.

A shape is measured at points; a picture of the arm needs it at link ends. The twists at the
joints and link interfaces that explain the measured motion with the least effort carry it there:
joints turn freely, interfaces only where the joints alone do not explain what was measured.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.protocols.arm.records import Arm, Point

__all__ = ["ShapeMotion", "measured_motion"]

ComplexArray = npt.NDArray[np.complex128]

_INTERFACE_EFFORT = 10.0  # of an interface turning, against a joint
_RIDGE = 1e-3  # of the largest singular value


class ShapeMotion:
    """Carries shapes of one posture from measured points to places on links.

    Parameters
    ----------
    arm
        The arm.
    joints_rad
        (n_joints,) the posture.
    link
        (n,) number of the link each place rides on, -1 the base.
    position_link_m
        (n, 3) the places in their links' frames.
    """

    def __init__(
        self,
        arm: Arm,
        joints_rad: npt.ArrayLike,
        link: npt.ArrayLike,
        position_link_m: npt.ArrayLike,
    ) -> None:
        names = [joint.link.name for joint in arm.joints]
        places = tuple(
            Point(
                id=f"place {number}",
                link="base" if on < 0 else names[on],
                position_m=position,
                R_link_sensor=np.eye(3),
            )
            for number, (on, position) in enumerate(
                zip(
                    np.asarray(link, dtype=int).tolist(),
                    np.asarray(position_link_m, dtype=np.float64),
                    strict=True,
                )
            )
        )
        superset = Superset(replace(arm, points=places))
        self._jacobian = superset.posture(joints_rad).point_jacobian[:, :3]
        effort = np.full(superset.n, _INTERFACE_EFFORT)
        effort[[superset.joint_column(i) for i in range(superset.n_joints)]] = 1.0
        self._effort = effort

    def motion(self, measured: MeasuredModes, shape: ComplexArray) -> ComplexArray:
        """Motion (n, 3) of the places in base, in the unit of the shape (n_dofs,)."""
        rows = measured.rows(measured.dynamics.point_jacobian) / self._effort
        U, S, Vh = np.linalg.svd(rows, full_matrices=False)
        if not S.size or S[0] == 0.0:
            return np.zeros((len(self._jacobian), 3), dtype=np.complex128)
        ridge = (_RIDGE * S[0]) ** 2
        twist = (Vh.T * (S / (S**2 + ridge))) @ (U.T @ shape) / self._effort
        moved: ComplexArray = self._jacobian @ twist
        return moved


def measured_motion(measured: MeasuredModes, shape: ComplexArray, n_points: int) -> ComplexArray:
    """Motion (n_points, 3) of the test points in base as measured, 0 where nothing was."""
    moved = np.zeros((n_points, 3), dtype=np.complex128)
    for point in np.unique(measured.index):
        rows = measured.index == point
        # One or two axes tell the motion along themselves alone: the least-norm solution.
        moved[point] = np.linalg.lstsq(
            measured.directions[rows].astype(np.complex128), shape[rows], rcond=1e-6
        )[0]
    return moved
