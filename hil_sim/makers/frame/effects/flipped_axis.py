"""One axis of the sensor points the other way, at all points."""

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = None


def where(drawn: Everyday) -> list[str]:
    """All points alike."""
    del drawn
    return ["all"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Spoil the record."""
    del place, size
    axis = int(kit.rng.integers(3))
    kit.gear.response = kit.gear.response.copy()
    kit.gear.response[axis] *= -1.0
    return {"axis": "xyz"[axis]}
