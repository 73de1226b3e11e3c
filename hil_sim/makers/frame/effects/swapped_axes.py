"""Two axes of the sensor are plugged the wrong way round, at all points."""

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
    pair = [(0, 1), (0, 2), (1, 2)][int(kit.rng.integers(3))]
    kit.gear.response = kit.gear.response.copy()
    kit.gear.response[list(pair)] = kit.gear.response[list(pair[::-1])]
    return {"axes": ["xyz"[axis] for axis in pair]}
