"""A joint whose zero has been lost: it stands elsewhere than is told."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (0.1, 30.0)  # degrees


def where(drawn: Everyday) -> list[str]:
    """Any joint but the first, which turns all directions alike."""
    return [row.joint for row in drawn.table.links[1:]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Turn the arm behind the joint."""
    told = float(size * kit.rng.choice([-1.0, 1.0]))
    kit.parts.offsets_rad[place] -= np.deg2rad(told)
    return {"offset_deg": told}  # the encoder tells that much more than is true
