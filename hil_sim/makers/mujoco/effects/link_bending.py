"""A link that bends: its outer half turns about both axes across its shell."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.mujoco.split import outer_half

SPAN = (0.004, 3.0)  # compliance of the bend over the arm's
UNEVEN = (0.0, 1.5)  # ln of the bend about one axis over that about the other: open castings
LOSS_TIME_S = (1e-5, 2e-4)


def places(drawn: Ordinary) -> list[str]:
    """One of the long links."""
    return list(drawn.table.long_links)


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Let the halves bend against each other, in place of the ordinary bend."""
    row = rig.row(place)
    outer, at, tangent = outer_half(rig.machine, row)
    stiffness, loss = 1.0 / (size * rig.compliance), float(rig.rng.uniform(*LOSS_TIME_S))
    outer.axes = [axis for axis in outer.axes if not axis.name.startswith("bend ")]
    uneven = float(np.exp(rig.rng.uniform(*UNEVEN)))
    first, second = np.linalg.svd(tangent[None, :])[2][1:]
    roll = float(rig.rng.uniform(0.0, np.pi))
    axes = (
        (np.cos(roll) * first + np.sin(roll) * second, 2.0 * uneven / (1.0 + uneven)),
        (np.cos(roll) * second - np.sin(roll) * first, 2.0 / (1.0 + uneven)),
    )
    for i, (direction, softer) in enumerate(axes):
        outer.axes.append(
            Axis(
                name=f"bend {place} {i + 1}",
                direction=direction,
                at_m=at,
                stiffness=stiffness / softer,
                damping=loss * stiffness / softer,
            )
        )
    length = float(np.sum(np.linalg.norm(np.diff(np.array(row.shell.path), axis=0), axis=1)))
    return {
        "hinge_n_m_per_rad": stiffness,
        "bending_stiffness_n_m2": stiffness * length,
        "loss_time_s": loss,
    }
