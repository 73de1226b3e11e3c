"""Drives that lose by amplitude, not by speed: a loss factor the same at all frequencies."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.modal import loss_law
from armodal.hil_sim.makers.frame.structure import Complex, Law
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

RANGE = (0.01, 0.28)  # loss factor; beyond 0.32 nothing is stiff at rest by this law
# Where a drive has its stiffness, and where an arm file tells it.
OWN_AT_HZ = 18.0  # of this maker: no arm has a word on it
REST, TOLD = (2.0j * np.pi * np.array([f_hz]) for f_hz in (OWN_AT_HZ, STIFFNESS_AT_HZ))


def where(drawn: Everyday) -> list[str]:
    """All elastic joints together."""
    return ["|".join(drawn.elastic)]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Give every drive nearly constant hysteresis in place of its own law."""
    for joint in place.split("|"):
        drive = kit.parts.drives[joint]
        drive.law = drive.own_law = _law(size * drive.stiffness)
    # Over the stiffness that an arm file means.
    at_rest = 1.0 - size * loss_law(REST)[0].real
    return {"loss_factor": size / (at_rest + size * loss_law(TOLD)[0].real)}


def _law(scale: float) -> Law:
    def law(s: Complex) -> Complex:
        # What the law adds to the stiffness there belongs to the drive's.
        lossy: Complex = scale * (loss_law(s) - loss_law(REST)[0].real)
        return lossy

    return law
