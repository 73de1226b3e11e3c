"""Mass matrices, gravity and positions of many postures at once.

Every link gets a frame whose z is its joint's axis. Then one posture differs from another only by
turns about z, and in the complex pairs

    h+ = hx + i hy,   J+ = Jxz + i Jyz,   D+ = (Jxx - Jyy)/2 + i Jxy

of the inertial parameters a turn by q multiplies by e^{iq}, e^{iq} and e^{2iq}. The step from one
frame to the next at q = 0 is linear in the parameters, so it is one constant matrix for all
postures. What remains per posture is the composite rigid body algorithm on arrays.

References
----------
Mass matrix: file 002, Eqs. (4) and (5). Composite bodies: R. Featherstone, Rigid Body Dynamics
Algorithms (2008), section 6.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm, InertialLink
from armodal.protocols.errors import ArmError

__all__ = [
    "ArmBatch",
    "axis_to_z",
    "flat_inertia",
    "inertia_step",
    "turn",
    "turn_inertia",
    "wrench_step",
]

Array = npt.NDArray[np.float64]

# Inertial parameters of a body about its frame's origin, in this order:
# m, hx, hy, hz, Jxx, Jyy, Jzz, Jxy, Jxz, Jyz, with h = m c and J the inertia about the origin.
_N_PARAMETERS = 10


class ArmBatch:
    """An arm prepared for many postures.

    Parameters
    ----------
    arm
        The arm; of its joints all are taken as revolute about their axes.

    Notes
    -----
    Arrays here are (..., n_postures): one quantity of all postures lies together in memory.
    """

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.n_joints = len(arm.joints)
        turned = [axis_to_z(joint.axis) for joint in arm.joints]
        self._turned = turned
        self._bodies = list(self.parameters([joint.link for joint in arm.joints]))
        before = [np.eye(3), *turned[:-1]]
        self._R = [
            B0.T @ joint.T_parent_joint[:3, :3] @ B1
            for joint, B0, B1 in zip(arm.joints, before, turned, strict=True)
        ]
        self._p = [
            B0.T @ joint.T_parent_joint[:3, 3] for joint, B0 in zip(arm.joints, before, strict=True)
        ]
        self._inertia_step = [inertia_step(R, p) for R, p in zip(self._R, self._p, strict=True)]
        self._wrench_step = [wrench_step(R, p) for R, p in zip(self._R, self._p, strict=True)]

    def with_links(self, links: Sequence[InertialLink]) -> ArmBatch:
        """Return the same arm with other inertias, one link per joint; its geometry is shared."""
        joints = tuple(
            replace(joint, link=link) for joint, link in zip(self.arm.joints, links, strict=True)
        )
        other = copy(self)
        vars(other).update(
            arm=replace(self.arm, joints=joints),
            _bodies=list(self.parameters(links)),
        )
        return other

    def parameters(self, links: Sequence[InertialLink]) -> Array:
        """Inertial parameters (n_joints, 10) of links, one per joint, for `mass_slope`."""
        wanted = zip(range(self.n_joints), links, strict=True)
        return np.stack([self.parameters_of(i, link) for i, link in wanted])

    def parameters_of(self, joint: int, link: InertialLink) -> Array:
        """Inertial parameters (10,) of the link that a joint moves."""
        return _parameters(link, self._turned[joint])

    def mass_slope(self, joints_rad: npt.ArrayLike) -> Array:
        """Slope of the mass matrices by the links' inertial parameters.

        Mass matrices are linear in them: M = slope · parameters, over the last two axes.

        Returns
        -------
        (n_joints, n_joints, n_postures, n_joints, 10) float64
        """
        n, count = self.n_joints, len(np.atleast_2d(joints_rad))
        slope = np.empty((n, n, count, n, _N_PARAMETERS))
        unit = copy(self)
        for link in range(n):
            for number in range(_N_PARAMETERS):
                bodies = np.zeros((n, _N_PARAMETERS))
                bodies[link, number] = 1.0
                vars(unit)["_bodies"] = list(bodies)
                slope[..., link, number] = unit.mass(joints_rad)
        return slope

    def mass(self, joints_rad: npt.ArrayLike) -> Array:
        """Mass matrices.

        Parameters
        ----------
        joints_rad
            (n_postures, n_joints).

        Returns
        -------
        (n_joints, n_joints, n_postures) float64
            kg m², symmetric in the first two.
        """
        cosine, sine = self._turns(joints_rad)
        n, count = self.n_joints, cosine.shape[1]
        mass = np.empty((n, n, count))
        composite = np.empty((_N_PARAMETERS, count))
        composite[:] = self._bodies[-1][:, None]
        for i in reversed(range(n)):
            mass[i, i] = composite[6]
            # Momentum of the composite body turning about z at unit rate: linear, angular.
            wrench = np.zeros((6, count))
            np.negative(composite[2], out=wrench[0])
            wrench[1] = composite[1]
            wrench[3], wrench[4], wrench[5] = composite[8], composite[9], composite[6]
            for j in reversed(range(i)):
                turn(wrench, cosine[j + 1], sine[j + 1], ((0, 1), (3, 4)))
                wrench = self._wrench_step[j + 1] @ wrench
                mass[i, j] = mass[j, i] = wrench[5]
            if i:
                turn_inertia(composite, cosine[i], sine[i])
                composite = self._inertia_step[i] @ composite
                composite += self._bodies[i - 1][:, None]
        return mass

    def masses(self, joints_rad: npt.ArrayLike) -> tuple[Array, Array]:
        """Mass matrices of the joints, and of the coordinates: here the same."""
        mass = self.mass(joints_rad)
        return mass, mass

    def position(self, joints_rad: npt.ArrayLike, link: int, point_m: npt.ArrayLike) -> Array:
        """Positions in base of a point fixed in a link's own frame.

        Returns
        -------
        (3, n_postures) float64
            Metres.
        """
        point = np.asarray(point_m, dtype=np.float64)[None]
        place: Array = self.positions(joints_rad, link, point)[0]
        return place

    def positions(self, joints_rad: npt.ArrayLike, link: int, points_m: npt.ArrayLike) -> Array:
        """Positions in base (n_points, 3, n_postures) of points (n_points, 3) of a link."""
        cosine, sine = self._turns(joints_rad)
        local = self._turned[link].T @ np.asarray(points_m, dtype=np.float64).T
        places = np.repeat(local[:, :, None], cosine.shape[1], axis=2)
        for j in reversed(range(link + 1)):
            places = self._in_parent(j, places, cosine, sine)
        return places.transpose(1, 0, 2)

    def _in_parent(self, joint: int, places: Array, cosine: Array, sine: Array) -> Array:
        """Places (3, n_points, n_postures) of a joint's link in its parent's axes."""
        turn(places, cosine[joint], sine[joint], ((0, 1),))
        moved = self._R[joint] @ places.reshape(3, -1)
        return moved.reshape(places.shape) + self._p[joint][:, None, None]

    def joint_axes(self, joints_rad: npt.ArrayLike) -> tuple[Array, Array]:
        """Lines of the joint axes in base.

        Returns
        -------
        origin, direction : (n_joints, 3, n_postures) float64
            A point of each axis in metres, and its unit direction.
        """
        cosine, sine = self._turns(joints_rad)
        count = cosine.shape[1]
        places = np.empty((3, 0, count))
        for j in reversed(range(self.n_joints)):
            ends = np.stack([np.zeros(3), self._turned[j].T @ self.arm.joints[j].axis], axis=1)
            own = np.repeat(ends[:, :, None], count, axis=2)
            places = self._in_parent(j, np.concatenate([own, places], axis=1), cosine, sine)
        origin, ahead = places[:, ::2].transpose(1, 0, 2), places[:, 1::2].transpose(1, 0, 2)
        return origin, ahead - origin

    def unit_motions(self, joints_rad: npt.ArrayLike, tool_m: npt.ArrayLike) -> tuple[Array, Array]:
        """Motion of a point of the last link by a unit of each coordinate.

        Parameters
        ----------
        tool_m
            (3,) in the last link's frame.

        Returns
        -------
        J, tool : (6, n_joints, n_postures), (3, n_postures) float64
            Base frame, linear first; the point's place.
        """
        origin, direction = self.joint_axes(joints_rad)
        tool = self.position(joints_rad, self.n_joints - 1, tool_m)
        linear = np.cross(direction, tool[None] - origin, axis=1)
        return np.concatenate([linear, direction], axis=1).transpose(1, 0, 2), tool

    def gravity_torque(self, joints_rad: npt.ArrayLike) -> Array:
        """Torques that hold the arm against gravity.

        Returns
        -------
        (n_joints, n_postures) float64
            N m, g(q) of file 002, section 2.
        """
        cosine, sine = self._turns(joints_rad)
        n, count = self.n_joints, cosine.shape[1]
        gravity = self._gravity_in_links(cosine, sine)
        torque = np.empty((n, count))
        composite = np.empty((_N_PARAMETERS, count))
        composite[:] = self._bodies[-1][:, None]
        for i in reversed(range(n)):
            g = gravity[i]
            torque[i] = composite[2] * g[0] - composite[1] * g[1]  # -(h x g) . z
            if i:
                turn_inertia(composite, cosine[i], sine[i])
                composite = self._inertia_step[i] @ composite + self._bodies[i - 1][:, None]
        return torque

    def _gravity_in_links(self, cosine: Array, sine: Array) -> list[Array]:
        g = np.repeat(np.asarray(self.arm.gravity_m_s2, float)[:, None], cosine.shape[1], axis=1)
        seen = []
        for j in range(self.n_joints):
            g = self._R[j].T @ g
            turn(g, cosine[j], -sine[j], ((0, 1),))
            seen.append(g.copy())
        return seen

    def _turns(self, joints_rad: npt.ArrayLike) -> tuple[Array, Array]:
        angles = np.asarray(joints_rad, dtype=np.float64)
        if angles.ndim != 2 or angles.shape[1] != self.n_joints:
            raise ArmError(
                f"wanted joint angles of shape (postures, {self.n_joints}) for arm "
                f"'{self.arm.name}', got {angles.shape}; give one angle per joint in each row"
            )
        columns = np.ascontiguousarray(angles.T)
        return np.cos(columns), np.sin(columns)


def axis_to_z(axis: Array) -> Array:
    """Rotation whose third column is the axis."""
    z = np.asarray(axis, dtype=np.float64)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _parameters(link: InertialLink, B: Array) -> Array:
    center = B.T @ link.center_m
    J = B.T @ link.inertia_kg_m2 @ B
    J = J + link.mass_kg * (center @ center * np.eye(3) - np.outer(center, center))
    return flat_inertia(link.mass_kg, link.mass_kg * center, J)


def flat_inertia(mass: float, h: Array, J: Array) -> Array:
    """Return a body's ten parameters from mass, first moments (3,) and inertia (3, 3) at origin."""
    return np.array(
        [mass, *h, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]], dtype=np.float64
    )


def inertia_step(R: Array, p: Array) -> Array:
    """Constant (10, 10) matrix that takes parameters from a link's frame to its parent's."""
    step = np.empty((_N_PARAMETERS, _N_PARAMETERS))
    for column, unit in enumerate(np.eye(_N_PARAMETERS)):
        mass, h = unit[0], R @ unit[1:4]
        xx, yy, zz, xy, xz, yz = unit[4:]
        J = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
        # About the parent's origin: J + m (p² - p pᵀ) + the mixed terms of h and p.
        J = J + mass * (p @ p * np.eye(3) - np.outer(p, p))
        J = J + 2 * (p @ h) * np.eye(3) - np.outer(p, h) - np.outer(h, p)
        step[:, column] = flat_inertia(float(mass), h + mass * p, J)
    return step


def wrench_step(R: Array, p: Array) -> Array:
    """Constant (6, 6) matrix that takes a wrench, linear first, to the parent's frame."""
    cross = np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])
    return np.block([[R, np.zeros((3, 3))], [cross @ R, R]])


def turn(rows: Array, cosine: Array, sine: Array, pairs: tuple[tuple[int, int], ...]) -> None:
    """Turn pairs of rows about z, in place."""
    for a, b in pairs:
        x = cosine * rows[a] - sine * rows[b]
        rows[b] = sine * rows[a] + cosine * rows[b]
        rows[a] = x


def turn_inertia(parameters: Array, cosine: Array, sine: Array) -> None:
    """Turn inertial parameters (10, n_postures) about z, in place."""
    turn(parameters, cosine, sine, ((1, 2), (8, 9)))
    middle = 0.5 * (parameters[4] + parameters[5])
    difference = 0.5 * (parameters[4] - parameters[5])
    cosine_2, sine_2 = 1.0 - 2.0 * sine * sine, 2.0 * sine * cosine
    turned = cosine_2 * difference - sine_2 * parameters[7]
    parameters[7] = sine_2 * difference + cosine_2 * parameters[7]
    parameters[4] = middle + turned
    parameters[5] = middle - turned
