"""An arm in one posture as the gap models see it, and how that changes with its joint angles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.screws.cross import across, skew

__all__ = ["GeometryNear", "GeometrySlopes", "PostureGeometry", "across", "skew"]

Array = npt.NDArray[np.float64]

_NEAR_RAD = 0.02  # within which the first order is kept: the second is 2e-4


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureGeometry:
    """Jacobians of links and points over the N freedoms of the superset, linear first."""

    link_jacobian: Array  # (n_links, 6, N) each in its link's frame
    point_jacobian: Array  # (n_points, 6, N) base frame
    point_rotation: Array  # (n_points, 3, 3)
    gravity_per_mass: Array  # (n_links, 4, N, N)
    gravity_m_s2: Array  # (3,)


@dataclass(frozen=True, slots=True, kw_only=True)
class GeometrySlopes:
    """What of a posture's geometry changes with each of its n_joints angles, per rad.

    A link beyond a joint sees all that is before the joint move the other way: its Jacobian changes
    by minus `to_link` times `before`.
    """

    before: Array  # (n_joints, 6, N) base frame
    to_link: Array  # (n_links, 6, 6) from a twist about the base to one in the link's frame
    link_jacobian: Array  # (n_joints, n_links, 6, N)
    point_jacobian: Array  # (n_joints, n_points, 6, N)
    point_rotation: Array  # (n_joints, n_points, 3, 3)


class GeometryNear:
    """Geometry at angles near those that were read.

    It is linear in the angles about a centre that follows them; gravity's small stiffness stays
    that of the angles read.
    """

    def __init__(self, superset: Superset, joints_rad: Array) -> None:
        self._superset = superset
        self._read = np.array(joints_rad, dtype=np.float64)
        self._gravity = superset.gravity_stiffness_per_mass(self._read)
        self._centre = np.full_like(self._read, np.inf)
        self._centre_on(np.zeros_like(self._read))

    def at(self, offset_rad: Array) -> PostureGeometry:
        """Geometry where the joints stand `offset_rad` (n_joints,) beyond what was read."""
        if np.max(np.abs(offset_rad - self._centre), initial=0.0) > _NEAR_RAD:
            self._centre_on(offset_rad)
        now = self._start + (offset_rad - self._centre) @ self._slope
        link, point, rotation = (
            now[part].reshape(shape) for part, shape in zip(self._parts, self._shapes, strict=True)
        )
        return PostureGeometry(
            link_jacobian=link,
            point_jacobian=point,
            point_rotation=rotation,
            gravity_per_mass=self._gravity,
            gravity_m_s2=self._gravity_m_s2,
        )

    def slopes(self) -> GeometrySlopes:
        """Return how the geometry of the last `at` changes with the angles."""
        return self._slopes

    def _centre_on(self, offset: Array) -> None:
        self._centre = offset.copy()
        dynamics = self._superset.posture(self._read + offset)
        self._gravity_m_s2 = dynamics.gravity_m_s2
        self._slopes = _slopes(self._superset, dynamics)
        start = (dynamics.link_jacobian, dynamics.point_jacobian, dynamics.point_rotation)
        slope = (
            self._slopes.link_jacobian,
            self._slopes.point_jacobian,
            self._slopes.point_rotation,
        )
        ends = np.cumsum([0, *(own.size for own in start)]).tolist()
        self._parts = [slice(a, b) for a, b in pairwise(ends)]
        self._shapes = [own.shape for own in start]
        self._start = np.concatenate([own.ravel() for own in start])
        self._slope = np.concatenate([own.reshape(len(own), -1) for own in slope], axis=1)


def _slopes(superset: Superset, dynamics: PostureDynamics) -> GeometrySlopes:
    """Derivatives by the joints' angles.

    Turning joint j carries all that is beyond it with its twist S_j: dS_i / dq_j = S_j x S_i for
    coordinates i beyond j. Seen from a link beyond j, what is before j moves the other way.

    Featherstone, Rigid Body Dynamics Algorithms (2008), Eq. (2.45): the motion cross product.
    """
    n, n_joints = superset.n, superset.n_joints
    R, p = dynamics.T_base_link[:, :3, :3], dynamics.T_base_link[:, :3, 3]
    last = dynamics.link_jacobian[-1]
    turn = R[-1] @ last[3:]
    S = np.concatenate([R[-1] @ last[:3] + skew(p[-1]) @ turn, turn])  # (6, n) about the base
    at = np.array([superset.joint_column(joint) for joint in range(n_joints)])
    v, w = skew(S[:3, at].T), skew(S[3:, at].T)  # (n_joints, 3, 3)
    bracket = np.concatenate([w @ S[:3] + v @ S[3:], w @ S[3:]], axis=1)  # (n_joints, 6, n)
    beyond = np.arange(n) > at[:, None]  # (n_joints, n) coordinates beyond each joint
    carried = bracket * beyond[:, None]

    links = np.arange(n_joints)
    before = np.where(beyond[:, None], 0.0, bracket)
    back = R.swapaxes(1, 2)
    to_link = np.zeros((n_joints, 6, 6))
    to_link[:, :3, :3] = to_link[:, 3:, 3:] = back
    to_link[:, :3, 3:] = -back @ skew(p)
    moves = links >= links[:, None]  # (n_joints, n_links) whether a link is beyond each joint
    by_link = -(to_link @ before[:, None]) * moves[:, :, None, None]

    position, on = dynamics.point_position, np.array(superset.point_link)
    moved = S[:3, at].T[:, None] + (w[:, None] @ position[..., None])[..., 0]  # (n_joints, k, 3)
    own = np.array([np.arange(n) < 6 + 7 * (link + 1) for link in on])  # (k, n) before each point
    arm = skew(position)
    linear = carried[:, None, :3] - arm @ carried[:, None, 3:] - skew(moved) @ S[3:]
    angular = np.broadcast_to(carried[:, None, 3:], linear.shape)
    with_it = on >= links[:, None]  # (n_joints, k)
    by_point = np.concatenate([linear, angular], axis=2)
    by_point = by_point * (own[None] & with_it[:, :, None])[:, :, None]
    turned = w[:, None] @ dynamics.point_rotation * with_it[:, :, None, None]
    return GeometrySlopes(
        before=before,
        to_link=to_link,
        link_jacobian=by_link,
        point_jacobian=by_point,
        point_rotation=turned,
    )
