"""A joint that is believed rigid gives way."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

WRIST = "rigid"  # the only one with such a joint
SPAN = (0.02, 60.0)  # its compliance over the arm's
LOSS_TIME_S = (5e-5, 1e-3)


def places(drawn: Ordinary) -> list[str]:
    """A joint of a rigid wrist; none where all joints are known to be elastic."""
    return [row.joint for row in drawn.table.links if row.joint not in drawn.elastic]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Give the joint a spring."""
    body = rig.machine.moved_by(place)
    stiffness, loss = 1.0 / (size * rig.compliance), float(rig.rng.uniform(*LOSS_TIME_S))
    body.axes.insert(
        0,
        Axis(
            name=place,
            direction=body.drive_axis,
            at_m=np.zeros(3),
            stiffness=stiffness,
            damping=loss * stiffness,
        ),
    )
    return {"stiffness_n_m_per_rad": stiffness, "loss_time_s": loss}
