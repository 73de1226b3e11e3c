"""The torque that an arm's weight puts on a freedom."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.protocols.arm.records import InertialLink

__all__ = ["gravity_load"]


def gravity_load(geometry: PostureGeometry, links: tuple[InertialLink, ...], column: int) -> float:
    """Torque in N m that the links' believed weight puts on a freedom of the superset."""
    J = geometry.link_jacobian
    weight = J[:, :3, :3] @ geometry.gravity_m_s2  # of a kg, along each link's axes
    centers = np.array([link.center_m for link in links])
    motion = J[:, :3, column] + np.cross(J[:, 3:, column], centers)
    return float(np.array([link.mass_kg for link in links]) @ np.sum(weight * motion, axis=1))
