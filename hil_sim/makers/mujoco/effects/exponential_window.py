"""The recorder has put an exponential window on force and response."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 5.0)  # of -ln of its end


def places(drawn: Ordinary) -> list[str]:
    """There is one."""
    del drawn
    return ["all"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Spoil the measurement."""
    del place
    rig.bench.window_end = float(np.exp(-size))
    return {"end": rig.bench.window_end}
