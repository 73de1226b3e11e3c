"""In one posture every hit came from elsewhere than the plan says."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import turned
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (3.0, 60.0)  # degrees
POSTURE = "posture 1"


def places(drawn: Ordinary) -> list[str]:
    """Of the hammer."""
    del drawn
    return ["hammer"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Turn the hits of the first posture about a drawn axis."""
    del place
    axis = rig.direction()
    turn = turned(axis, float(np.deg2rad(size)))[:3, :3]
    rig.bench.turned_hits[POSTURE] = turn
    return {"posture": POSTURE, "turn_deg": (size * axis).tolist()}
