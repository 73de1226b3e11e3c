"""The response comes late against the force, or early."""

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (2e-5, 5e-3)  # s


def places(drawn: Ordinary) -> list[str]:
    """Of the accelerometer's channels, or of the hammer's."""
    del drawn
    return ["accelerometer", "hammer"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Shift the response."""
    rig.bench.late_s = size if place == "accelerometer" else -size
    return {"delay_s": size}
