"""A joint stands elsewhere than its encoder tells."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import turned
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.2, 20.0)  # degrees


def places(drawn: Ordinary) -> list[str]:
    """Any joint but the first, whose angle turns everything alike."""
    return [row.joint for row in drawn.table.links[1:]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Turn the joint's zero."""
    body, sign = rig.machine.moved_by(place), float(rig.rng.choice([-1.0, 1.0]))
    turn = turned(body.drive_axis, float(np.deg2rad(sign * size)))
    body.T_parent_body = body.T_parent_body @ turn
    return {"offset_deg": -sign * size}  # the encoder reads that much more than the true angle
