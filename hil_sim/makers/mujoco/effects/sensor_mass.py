"""The sensor with its mounting is heavier than the plan says."""

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.001, 0.1)  # of the last link's mass with its tool


def places(drawn: Ordinary) -> list[str]:
    """There is one."""
    del drawn
    return ["accelerometer"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Spoil the measurement."""
    del place
    rig.bench.extra_kg = size * rig.drawn.table.inertials()[-1].mass_kg
    return {"extra_kg": rig.bench.extra_kg}
