"""A worn bearing: a joint's link tilts about both axes across the drive's."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.02, 4.0)  # tilt compliance over the drive's compliance
LOSS_TIME_S = (2e-5, 4e-4)


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Let the bearing tilt by `size` times the drive's compliance, beside the ordinary."""
    body, drive = rig.machine.moved_by(place), rig.drive(place)
    worn, loss = drive.stiffness / size, float(rig.rng.uniform(*LOSS_TIME_S))
    for i, direction in enumerate(np.linalg.svd(body.drive_axis[None, :])[2][1:]):
        body.axes = [axis for axis in body.axes if axis.name != f"bearing {place} {i + 1}"]
        body.axes.append(
            Axis(
                name=f"bearing {place} {i + 1}",
                direction=direction,
                at_m=np.zeros(3),
                stiffness=worn,
                damping=loss * worn,
            )
        )
    return {"compliance_rad_per_n_m": 1.0 / worn, "loss_time_s": loss}
