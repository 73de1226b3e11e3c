"""A spring that pulls the second link up against gravity, from frame to link."""

import numpy as np

from armodal.hil_sim.makers.arm_table import rotation
from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.shell_points import along

SPAN = (0.005, 0.8)  # stiffness about the joint over the drive's
EYE = (0.2, 0.5)  # of the link's shell, where the spring holds it
FREE = (0.6, 0.95)  # length unstressed over that in the first posture


def places(drawn: Ordinary) -> list[str]:
    """The second joint."""
    return [drawn.elastic[1]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Hang the spring; its force and its direction change with the posture."""
    row, parent = rig.row(place), rig.machine.moved_by(place).parent
    eye, _ = along(row.shell, float(rig.rng.uniform(*EYE)))
    reach = float(np.linalg.norm(eye))
    anchor = np.array(row.xyz_m) + 1.2 * reach * rig.direction()
    levers = eye, rotation(row.rpy_rad).T @ (anchor - np.array(row.xyz_m))
    stiffness = size * rig.drive(place).stiffness / reach**2
    rig.machine.springs.append(
        Spring(
            name="compensator",
            ends=((parent, anchor), (row.link, eye)),
            stiffness=stiffness,
            rest_m=float(rig.rng.uniform(*FREE)) * 1.2 * reach,
        )
    )
    return {
        "stiffness_n_per_m": stiffness,
        "anchor_m": anchor.tolist(),
        "eye_m": eye.tolist(),
        "shorter_lever_m": min(float(np.hypot(x, y)) for x, y, _ in levers),
    }
