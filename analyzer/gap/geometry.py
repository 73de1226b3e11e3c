"""An arm in one posture as the gap models see it, and how that changes with its joint angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import PostureDynamics, Superset

__all__ = ["PostureGeometry", "geometry_at", "moved_geometry"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureGeometry:
    """Jacobians of links and points over the N freedoms of the superset, linear first."""

    joints_rad: Array  # (n_joints,)
    link_jacobian: Array  # (n_links, 6, N) each in its link's frame
    point_jacobian: Array  # (n_points, 6, N) base frame
    point_rotation: Array  # (n_points, 3, 3)
    gravity_per_mass: Array  # (n_links, 4, N, N)
    gravity_m_s2: Array  # (3,)


def geometry_at(superset: Superset, joints_rad: Array) -> PostureGeometry:
    """Geometry of a posture."""
    return _of(superset.posture(joints_rad), superset.gravity_stiffness_per_mass(joints_rad))


def moved_geometry(
    superset: Superset, geometry: PostureGeometry, joints_rad: Array
) -> PostureGeometry:
    """Geometry of a posture near another; gravity's small stiffness is kept."""
    if np.array_equal(joints_rad, geometry.joints_rad):
        return geometry
    return _of(superset.posture(joints_rad), geometry.gravity_per_mass)


def _of(dynamics: PostureDynamics, gravity_per_mass: Array) -> PostureGeometry:
    return PostureGeometry(
        joints_rad=dynamics.joints_rad,
        link_jacobian=dynamics.link_jacobian,
        point_jacobian=dynamics.point_jacobian,
        point_rotation=dynamics.point_rotation,
        gravity_per_mass=gravity_per_mass,
        gravity_m_s2=dynamics.gravity_m_s2,
    )
