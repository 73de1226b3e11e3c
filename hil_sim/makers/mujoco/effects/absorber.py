"""A mass on a spring and a damper on a link: a box with its own mode."""

import numpy as np

from armodal.hil_sim.makers.arm_table import Inertial
from armodal.hil_sim.makers.mujoco.machine import Axis, Body
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.shell_points import along

SPAN = (0.0005, 0.15)  # of the arm's mass
OWN_HZ = (9.0, 45.0)
DAMPING_RATIO = (0.01, 0.08)


def places(drawn: Ordinary) -> list[str]:
    """A link from the second on."""
    return [row.link for row in drawn.table.links[1:]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Hang a mass on a slide in a drawn direction."""
    rng, row = rig.rng, rig.row(place)
    mass = size * sum(body.mass_kg for body in rig.drawn.table.inertials())
    omega = 2.0 * np.pi * float(np.exp(rng.uniform(*np.log(OWN_HZ))))
    ratio = float(rng.uniform(*DAMPING_RATIO))
    center = along(row.shell, float(rng.uniform(0.3, 1.0)))[0]
    direction = rig.direction()
    rig.machine.bodies["absorber"] = Body(
        name="absorber",
        parent=place,
        T_parent_body=np.eye(4),
        inertial=Inertial.of(mass, center, 1e-3 * mass * np.eye(3)),
        axes=[
            Axis(
                name="absorber",
                direction=direction,
                at_m=center,
                stiffness=mass * omega**2,
                damping=2.0 * ratio * mass * omega,
                slide=True,
            )
        ],
    )
    return {
        "mass_kg": mass,
        "frequency_hz": omega / (2.0 * np.pi),
        "damping_ratio": ratio,
        "direction": direction.tolist(),
        "center_m": center.tolist(),
    }
