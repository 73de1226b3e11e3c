"""One channel of the accelerometer has another gain than its certificate."""

import numpy as np

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 0.7)  # of ln of the gain


def places(drawn: Ordinary) -> list[str]:
    """All points alike."""
    del drawn
    return ["all"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Change a drawn channel's gain."""
    del place
    axis, factor = int(rig.rng.integers(3)), float(np.exp(size * rig.rng.choice([-1.0, 1.0])))
    gains = np.ones(3)
    gains[axis] = factor
    rig.bench.sensor = np.diag(gains) @ rig.bench.sensor
    return {"axis": "xyz"[axis], "factor": factor}
