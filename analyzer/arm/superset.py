"""The superset model: every joint, and six more freedoms at the root of every link and of the base.

One pinocchio model per arm holds a free interface of the base and, for each link, the drive joint
followed by a free interface of six degrees of freedom, all locked unless somebody asks. Locking
is deleting rows and columns, and a compliance axis inside a link is one combination of the link's
six interface columns, so a posture is evaluated once and every hypothesis about the structure is a
small matrix product.

An interface sits between a joint and all the mass of its link: what moves about an axis released
in link i is link i and everything beyond it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.rigid_links import LinkDynamics, RigidLinks, base_alone
from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ArmError

__all__ = ["PostureDynamics", "Superset"]

Array = npt.NDArray[np.float64]

_KEPT = 32  # postures: those of a session and its further tests are asked for again and again


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureDynamics:
    """The superset in one posture, linearised about rest.

    `n` counts the superset's degrees of freedom: six columns of the base (linear first, base
    frame), then per link one joint column and six interface columns (linear first, in the link's
    frame).
    """

    joints_rad: Array  # (n_joints,)
    mass: Array  # (n, n)
    gravity_stiffness: Array  # (n, n), dg/dq, symmetric
    point_jacobian: Array  # (n_points, 6, n), base frame, linear first, at the test points
    link_jacobian: Array  # (n_links, 6, n), each in its link's frame, linear first
    point_rotation: Array  # (n_points, 3, 3), columns are the sensor's axes in base
    point_position: Array  # (n_points, 3), base frame
    T_base_link: Array  # (n_links, 4, 4)
    gravity_m_s2: Array  # (3,)


class Superset:
    """Superset model of an arm of revolute joints.

    Parameters
    ----------
    arm
        The arm as described; its inertias are taken as they are.
    """

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.n_joints = len(arm.joints)
        self.n = 6 + 7 * self.n_joints
        link_index = {joint.link.name: i for i, joint in enumerate(arm.joints)}
        self._kept: dict[tuple[float, ...], PostureDynamics] = {}  # of the last postures
        self.point_index = {point.id: i for i, point in enumerate(arm.points)}
        # The link each test point rides on; -1 is the base.
        self.point_link = tuple(
            -1 if point.link == "base" else link_index[point.link] for point in arm.points
        )

    @staticmethod
    def joint_column(joint: int) -> int:
        """Return the superset column of joint number `joint` (0-based)."""
        return 6 + 7 * joint

    @staticmethod
    def interface_columns(link: int) -> slice:
        """Return the six columns, linear first, of the interface at the root of link `link`."""
        return slice(6 + 7 * link + 1, 6 + 7 * link + 7)

    def posture(self, joints_rad: npt.ArrayLike) -> PostureDynamics:
        """Evaluate mass, gravity stiffness and point Jacobians in a posture.

        Parameters
        ----------
        joints_rad
            (n_joints,) joint angles in radians.

        Raises
        ------
        ArmError
            If the number of angles is not the arm's or one is not finite.

        References
        ----------
        Mass matrix: file 002, Eqs. (4) and (5). Gravity stiffness: part of K in 002, Eq. (2).
        """
        return self.postures((joints_rad,))[0]

    def postures(self, joints_rad: Sequence[npt.ArrayLike]) -> tuple[PostureDynamics, ...]:
        """Evaluate several postures as `posture` does each."""
        every = [self._checked(angles) for angles in joints_rad]
        lacking = {key: angles for key, angles in every if key not in self._kept}
        if self.n_joints:
            found = self._links.postures(lacking.values()) if lacking else ()
        else:
            found = (base_alone(),) * len(lacking)
        new = {
            key: self._evaluated(angles, links)
            for (key, angles), links in zip(lacking.items(), found, strict=True)
        }
        known = self._kept | new
        self._kept = dict(list(known.items())[-_KEPT:])
        return tuple(known[key] for key, _ in every)

    def _checked(self, joints_rad: npt.ArrayLike) -> tuple[tuple[float, ...], Array]:
        angles = np.asarray(joints_rad, dtype=np.float64)
        if angles.shape != (self.n_joints,) or not np.isfinite(angles).all():
            raise ArmError(
                f"wanted {self.n_joints} finite joint angles for arm '{self.arm.name}', "
                f"got an array of shape {angles.shape}: {angles}; give one angle per joint"
            )
        return tuple(angles.tolist()), angles

    def _evaluated(self, angles: Array, found: LinkDynamics) -> PostureDynamics:
        gravity = found.gravity_stiffness
        jacobian, rotation, position = self._points(found)
        return PostureDynamics(
            joints_rad=frozen_array(angles, np.float64),
            mass=frozen_array(found.mass, np.float64),
            gravity_stiffness=frozen_array((gravity + gravity.T) / 2, np.float64),
            point_jacobian=frozen_array(jacobian, np.float64),
            link_jacobian=frozen_array(found.link_jacobian, np.float64),
            point_rotation=frozen_array(rotation, np.float64),
            point_position=frozen_array(position, np.float64),
            T_base_link=frozen_array(found.T_base_link, np.float64),
            gravity_m_s2=frozen_array(self.arm.gravity_m_s2, np.float64),
        )

    def gravity_stiffness_per_mass(self, joints_rad: npt.ArrayLike) -> Array:
        """Gravity stiffness that a unit mass and a unit first moment of each link bring.

        Returns
        -------
        (n_links, 4, n, n) float64
            dg/dq for a mass of 1 kg at each link's origin, then what 1 kg m of first moment along
            each axis of the link adds to it. Gravity's stiffness is linear in the four.
        """
        return self._links.gravity_stiffness_per_mass(np.asarray(joints_rad, dtype=np.float64))

    @cached_property
    def _links(self) -> RigidLinks:
        return RigidLinks(self.arm)

    def _points(self, found: LinkDynamics) -> tuple[Array, Array, Array]:
        n_points = len(self.arm.points)
        jacobian = np.zeros((n_points, 6, self.n))
        rotation = np.empty((n_points, 3, 3))
        position = np.empty((n_points, 3))
        # Twist of each link taken at the base origin, then moved to the point: v + w x p.
        for i, (point, link) in enumerate(zip(self.arm.points, self.point_link, strict=True)):
            T = np.eye(4) if link < 0 else found.T_base_link[link]
            position[i] = T[:3, :3] @ point.position_m + T[:3, 3]
            rotation[i] = T[:3, :3] @ point.R_link_sensor
            J = found.world_jacobian[link + 1]
            jacobian[i, 3:] = J[3:]
            x, y, z = position[i]
            skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            jacobian[i, :3] = J[:3] - skew @ J[3:]
        return jacobian, rotation, position
