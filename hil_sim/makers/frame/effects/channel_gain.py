"""One axis of the sensor tells too much or too little, at all points."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (0.01, 0.8)  # of ln of the gain


def where(drawn: Everyday) -> list[str]:
    """All points alike."""
    del drawn
    return ["all"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Spoil the record."""
    del place
    axis, factor = int(kit.rng.integers(3)), float(np.exp(size * kit.rng.choice([-1.0, 1.0])))
    kit.gear.response = kit.gear.response.copy()
    kit.gear.response[axis] *= factor
    return {"axis": "xyz"[axis], "factor": factor}
