"""Backlash: a part of the drive's spring takes hold only behind a gap."""

from armodal.hil_sim.makers.mujoco.effects.friction import middle_moment
from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 0.8)  # of the drive's stiffness, that is absent inside the gap
GAP = (0.2, 1.2)  # half width over the turn that a middle hit's moment makes


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Move a part of the spring behind the gap: the joint is stiffer under harder hits."""
    drive = rig.drive(place)
    half = float(rig.rng.uniform(*GAP)) * middle_moment(rig) / drive.stiffness
    part = size * drive.stiffness
    drive.stiffness -= part
    rig.machine.springs.append(
        Spring(name="backlash", axes={place: 1.0}, stiffness=part, dead_band=2.0 * half)
    )
    return {"half_rad": half, "part": size}
