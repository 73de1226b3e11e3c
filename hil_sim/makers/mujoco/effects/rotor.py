"""The inertia of a rotor that turns with the joint through the gear."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.002, 3.0)  # of the inertia that makes 20 Hz on the drive's spring


def places(drawn: Ordinary) -> list[str]:
    """Any elastic joint but the last."""
    return list(drawn.elastic[:-1])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Turn an armature with the joint."""
    drive = rig.drive(place)
    drive.inertia += size * drive.stiffness / (2.0 * np.pi * 20.0) ** 2
    return {"inertia_kg_m2": drive.inertia}
