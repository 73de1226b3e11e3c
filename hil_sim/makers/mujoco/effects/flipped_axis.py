"""One axis of the accelerometer has the wrong sign, at every point."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = None


def places(drawn: Ordinary) -> list[str]:
    """All points alike."""
    del drawn
    return ["all"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Turn a drawn axis round."""
    del place, size
    axis = int(rig.rng.integers(3))
    signs = np.ones(3)
    signs[axis] = -1.0
    rig.bench.sensor = np.diag(signs) @ rig.bench.sensor
    return {"axis": "xyz"[axis]}
