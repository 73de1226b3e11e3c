"""Two axes of the accelerometer are exchanged, at every point."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = None


def places(drawn: Ordinary) -> list[str]:
    """All points alike."""
    del drawn
    return ["all"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Exchange a drawn pair."""
    del place, size
    left = int(rig.rng.integers(3))
    pair = [axis for axis in range(3) if axis != left]
    order = np.arange(3)
    order[pair] = pair[::-1]
    rig.bench.sensor = rig.bench.sensor[order]
    return {"axes": ["xyz"[axis] for axis in pair]}
