"""A link that twists: its outer half turns about its shell's line."""

from armodal.hil_sim.makers.arms import arms_with
from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.mujoco.split import outer_half

SPAN = (0.005, 3.0)  # compliance of the twist over the arm's
LOSS_TIME_S = (1e-5, 2e-4)
ARMS = arms_with(lambda table: table.twisting_links)


def places(drawn: Ordinary) -> list[str]:
    """One of the long links that turn at neither end about their own line."""
    return list(drawn.table.twisting_links)


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Let the halves twist against each other."""
    row = rig.row(place)
    outer, at, tangent = outer_half(rig.machine, row)
    stiffness, loss = 1.0 / (size * rig.compliance), float(rig.rng.uniform(*LOSS_TIME_S))
    outer.axes.append(
        Axis(
            name=f"twist {place}",
            direction=tangent,
            at_m=at,
            stiffness=stiffness,
            damping=loss * stiffness,
        )
    )
    return {"hinge_n_m_per_rad": stiffness, "loss_time_s": loss}
