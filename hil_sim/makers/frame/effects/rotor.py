"""The inertia of a rotor, turned through the gear with the joint."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (0.003, 5.0)  # of the inertia that gives 15 Hz with the drive


def where(drawn: Everyday) -> list[str]:
    """An elastic joint but the last two."""
    return list(drawn.elastic[:-2])


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Let it turn with the joint's own angle."""
    drive = kit.parts.drives[place]
    drive.rotor_kg_m2 = size * drive.stiffness / (2.0 * np.pi * 15.0) ** 2
    return {"inertia_kg_m2": drive.rotor_kg_m2}
