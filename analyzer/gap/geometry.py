"""An arm in one posture as the gap models see it, and how that changes with its joint angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import PostureDynamics, Superset

__all__ = ["GeometryNear", "GeometrySlopes", "PostureGeometry"]

Array = npt.NDArray[np.float64]

_STEP_RAD = 1e-4  # of differences: the second order is 1e-8
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
    """What of a posture's geometry changes with each of its n_joints angles, per rad."""

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
        shift = offset_rad - self._centre
        return self._geometry(
            *(
                start + np.tensordot(shift, slope, axes=1)
                for start, slope in zip(self._start, self._slope, strict=True)
            )
        )

    def slopes(self) -> GeometrySlopes:
        """Return how the geometry of the last `at` changes with the angles."""
        return self._slopes

    def _centre_on(self, offset: Array) -> None:
        self._centre = offset.copy()
        q = self._read + offset
        self._gravity_m_s2, *self._start = _arrays(self._superset.posture(q))
        slopes = []
        for joint in range(len(q)):
            ends = []
            for side in (1.0, -1.0):
                moved = q.copy()
                moved[joint] += side * _STEP_RAD
                ends.append(_arrays(self._superset.posture(moved))[1:])
            slopes.append(
                [(a - b) / (2.0 * _STEP_RAD) for a, b in zip(ends[0], ends[1], strict=True)]
            )
        self._slope = [np.stack(kind) for kind in zip(*slopes, strict=True)]
        link, point, rotation = self._slope
        self._slopes = GeometrySlopes(
            link_jacobian=link, point_jacobian=point, point_rotation=rotation
        )

    def _geometry(self, link: Array, point: Array, rotation: Array) -> PostureGeometry:
        return PostureGeometry(
            link_jacobian=link,
            point_jacobian=point,
            point_rotation=rotation,
            gravity_per_mass=self._gravity,
            gravity_m_s2=self._gravity_m_s2,
        )


def _arrays(dynamics: PostureDynamics) -> tuple[Array, Array, Array, Array]:
    return (
        dynamics.gravity_m_s2,
        dynamics.link_jacobian,
        dynamics.point_jacobian,
        dynamics.point_rotation,
    )
