"""Drives that lose by amplitude, not by speed: a loss factor the same at all frequencies."""

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.modal import loss_law
from armodal.hil_sim.makers.frame.structure import Complex, Law

RANGE = (0.01, 0.5)  # loss factor


def where(drawn: Everyday) -> list[str]:
    """All elastic joints together."""
    return ["|".join(drawn.elastic)]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Give every drive nearly constant hysteresis in place of its own law."""
    for joint in place.split("|"):
        kit.parts.drives[joint].law = _law(size * kit.parts.drives[joint].stiffness)
    return {"loss_factor": size}


def _law(scale: float) -> Law:
    def law(s: Complex) -> Complex:
        lossy: Complex = scale * loss_law(s)
        # What the law adds to the stiffness at 20 Hz belongs to the drive's.
        at = loss_law(s[:1] * 0 + 125.66j).real
        return lossy - scale * at

    return law
