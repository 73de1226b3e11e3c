"""A joint whose stiffness changes with amplitude, without loss: a cubic law, softer or harder."""

from armodal.hil_sim.makers.mujoco.effects.friction import middle_moment
from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 30.0)  # change of stiffness at the turn that a middle hit's moment makes
SOFTEST = 0.04  # a cubic law may not run out of stiffness under the hardest hit


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Bend the spring's law, mostly harder; softer only where it stays far from its maximum."""
    drive = rig.drive(place)
    at = middle_moment(rig) / drive.stiffness
    sign = -1.0 if size < SOFTEST and rig.rng.random() < 0.5 else 1.0
    cubic = sign * size * drive.stiffness / at**2
    rig.machine.springs.append(Spring(name="bent law", axes={place: 1.0}, cubic=cubic))
    return {"at_rad": at, "part": -sign * size, "cubic_n_m_per_rad3": cubic}
