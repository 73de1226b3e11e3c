"""A wrist whose last axis is driven through the one before: turning that turns this."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.05, 1.5)  # turns of the last axis a turn of the one before
WRIST = "elastic"  # of a wrist that is believed rigid neither drive gives way


def places(drawn: Ordinary) -> list[str]:
    """The last two joints, where both are elastic."""
    last = tuple(row.joint for row in drawn.table.links[-2:])
    return [f"{last[0]}|{last[1]}"] if set(last) <= set(drawn.elastic) else []


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Span the last drive's spring over both axes."""
    before, last = place.split("|")
    axis = rig.drive(last)
    ratio = size * float(rig.rng.choice([-1.0, 1.0]))
    moved, axis.stiffness = 0.98 * axis.stiffness, 0.02 * axis.stiffness  # the rest holds gravity
    loss, axis.damping = 0.98 * axis.damping, 0.02 * axis.damping
    rig.machine.springs.append(
        Spring(
            name="wrist coupling",
            axes={last: 1.0, before: float(np.float64(ratio))},
            stiffness=moved,
            damping=loss,
        )
    )
    return {"ratio": ratio}
