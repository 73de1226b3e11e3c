"""The torque that an arm's weight puts on a freedom."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.protocols.arm.records import InertialLink
from armodal.protocols.plan_records import KnownMass

__all__ = ["gravity_load"]


def gravity_load(
    geometry: PostureGeometry,
    links: tuple[InertialLink, ...],
    column: int,
    bolted_on: KnownMass | None = None,
) -> float:
    """Torque in N m on a freedom of the superset: the links' believed weight and a known mass's."""
    J = geometry.link_jacobian
    weight = J[:, :3, :3] @ geometry.gravity_m_s2  # of a kg, along each link's axes

    def by_kg(link: int, center_m: npt.NDArray[np.float64]) -> float:
        motion = J[link, :3, column] + np.cross(J[link, 3:, column], center_m)
        return float(weight[link] @ motion)

    found = sum(link.mass_kg * by_kg(i, link.center_m) for i, link in enumerate(links))
    if bolted_on is not None:
        at = [link.name for link in links].index(bolted_on.link)
        found += bolted_on.mass_kg * by_kg(at, bolted_on.center_m)
    return found
