"""Postures in which the arm touches neither floor nor base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.workspace.batch import ArmBatch

__all__ = ["Clearance", "clear_postures"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Clearance:
    """What must be kept free, in the base's frame with z up."""

    floor_m: float = 0.0  # height of the floor
    margin_m: float = 0.05  # kept above the floor
    base_radius_m: float = 0.12  # of an upright cylinder about joint 1's axis
    base_height_m: float = 0.25  # of that cylinder above the floor


# Links 1 and 2 carry joints 1 and 2 and cannot reach the base they stand on.
_FIRST_FREE_LINK = 2


def clear_postures(
    batch: ArmBatch, joints_rad: npt.ArrayLike, clearance: Clearance
) -> npt.NDArray[np.bool_]:
    """Tell which postures are clear of floor and base, (n_postures,).

    Joint origins and test points stand for the links: what lies between them is not looked at.
    """
    q = np.asarray(joints_rad, dtype=np.float64)
    clear = np.ones(len(q), dtype=bool)
    links = {joint.link.name: i for i, joint in enumerate(batch.arm.joints)}
    places = [(i, np.zeros(3)) for i in range(_FIRST_FREE_LINK, batch.n_joints)]
    places += [
        (links[point.link], point.position_m)
        for point in batch.arm.points
        if links.get(point.link, -1) >= _FIRST_FREE_LINK
    ]
    for link, point in places:
        x, y, z = batch.position(q, link, point)
        low = z < clearance.floor_m + clearance.margin_m
        in_base = (np.hypot(x, y) < clearance.base_radius_m) & (
            z < clearance.floor_m + clearance.base_height_m
        )
        clear &= ~(low | in_base)
    return clear
