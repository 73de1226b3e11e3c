"""A sensor with a magnet that nobody counted."""

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

RANGE = (0.0005, 0.05)  # of the moving mass


def where(drawn: Everyday) -> list[str]:
    """There is one."""
    del drawn
    return ["accelerometer"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Spoil the record."""
    del place
    kit.gear.added_kg = size * kit.arm_kg()
    return {"extra_kg": kit.gear.added_kg}
