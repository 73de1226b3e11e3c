"""A base that stands on something soft: it rocks, turns and shifts."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.005, 2.0)  # rocking compliance over the arm's
ASKEW = (0.5, 2.0)  # of the second rocking stiffness over the first
TURN = (1.0, 4.0)  # of the stiffness about the vertical over that of rocking
LEG_M = (0.12, 0.4)  # root of rocking over shifting stiffness: half the distance of its feet
LOSS_TIME_S = (3e-5, 5e-4)


def places(drawn: Ordinary) -> list[str]:
    """There is one."""
    del drawn
    return ["base"]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Put all six ways of the base on springs, `size` times as soft as the arm."""
    rng, rock = rig.rng, 1.0 / (size * rig.compliance)
    other, turn = rock * rng.uniform(*ASKEW), rock * rng.uniform(*TURN)
    feet = rig.drawn.table.base_shell.diameter_m / 0.2 * rng.uniform(*LEG_M)
    shift, loss = rock / feet**2, float(rng.uniform(*LOSS_TIME_S))
    springs = [(False, rock), (False, other), (False, turn)]
    springs += [(True, shift), (True, shift), (True, 2.0 * shift)]
    rig.machine.bodies[place].axes = [
        Axis(
            name=f"base {i + 1}",
            direction=np.eye(3)[i % 3],
            at_m=np.zeros(3),
            stiffness=float(stiffness),
            damping=float(loss * stiffness),
            slide=slide,
        )
        for i, (slide, stiffness) in enumerate(springs)
    ]
    inertial = rig.drawn.machine.bodies[place].inertial
    return {
        "rock_x_n_m_per_rad": rock,
        "rock_y_n_m_per_rad": float(other),
        "turn_n_m_per_rad": float(turn),
        "shift_n_per_m": float(shift),
        "base_mass_kg": 0.0 if inertial is None else inertial.mass_kg,
        "loss_time_s": loss,
    }
