"""The response is recorded later or earlier than the force."""

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (1e-5, 8e-3)  # s


def where(drawn: Everyday) -> list[str]:
    """Of the response, or of the force."""
    del drawn
    return ["accelerometer", "hammer"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Spoil the record."""
    kit.gear.lag_s = size if place == "accelerometer" else -size
    return {"delay_s": size}
