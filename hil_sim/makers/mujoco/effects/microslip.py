"""Microslip of a joint: many Jenkins elements that slip one after the other (Iwan 1966)."""

import numpy as np

from armodal.hil_sim.makers.mujoco.effects.friction import middle_moment
from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.01, 0.7)  # of the drive's stiffness, that slips away in the end
ELEMENTS = 15
WIDEST = (0.3, 3.0)  # limit of the last element, of a middle hit's moment times its part


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Part the drive's spring: elements of one stiffness, limits evenly apart.

    The truth of the joint's stiffness is the spring beside them, as an arm file tells a seat.
    """
    drive = rig.drive(place)
    part = size * drive.stiffness
    most = float(rig.rng.uniform(*WIDEST)) * middle_moment(rig) * size
    for i, limit in enumerate(most * (np.arange(ELEMENTS) + 0.5) / ELEMENTS):
        share = part / ELEMENTS
        spring = Spring(name=f"microslip {i + 1}", axes={place: 1.0}, stiffness=share)
        spring.yields_at = float(limit) / part
        rig.machine.springs.append(spring)
    drive.stiffness -= part
    return {
        "stiffness_n_m_per_rad": part,
        "limit_n_m": most,
        "beside_n_m_per_rad": drive.stiffness,
    }
