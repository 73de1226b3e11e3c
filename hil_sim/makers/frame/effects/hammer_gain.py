"""A hammer whose sensitivity is not what its certificate says."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (0.01, 0.7)  # of ln of the gain


def where(drawn: Everyday) -> list[str]:
    """There is one."""
    del drawn
    return ["hammer"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Spoil the record."""
    del place
    factor = float(np.exp(size * kit.rng.choice([-1.0, 1.0])))
    kit.gear.force_gain *= factor
    return {"factor": factor}
