"""The hammer's gain is wrong."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 0.6)  # of ln of the gain


def places(drawn: Ordinary) -> list[str]:
    """There is one."""
    del drawn
    return ["hammer"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Spoil the measurement."""
    del place
    sign = float(rig.rng.choice([-1.0, 1.0]))
    rig.bench.hammer_gain *= float(np.exp(sign * size))
    return {"factor": float(np.exp(sign * size))}
