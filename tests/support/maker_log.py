"""A log of a move, from the MuJoCo maker's own equations: drives that turn far, springs behind."""

import mujoco
import mujoco.rollout
import numpy as np
from support.added import AXIS_DIRECTION, AXIS_POINT

from armodal.hil_sim.makers.belief import Believed, believed_arm
from armodal.hil_sim.makers.mujoco.compiled import compiled
from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.protocols.foreign.motion_log import MotionLog

STEPS = 4  # of the simulation a row
TOLERANCES = {
    "mass": 0.05,
    "inertia": 0.06,
    "center_m": 0.003,
    "encoder_offset_deg": 0.1,
    "sensor_tilt_deg": 0.5,
    "sensor_gain": 0.01,
    "hammer_gain": 0.01,
    "hit_direction_deg": 1.0,
}


def arm_of(ideal, loss_s):
    """The arm file of an ideal machine, its drives as they are."""
    k = {j: Believed(value=v, std=0.1 * v, source="made") for j, v in ideal.stiffness.items()}
    c = {
        j: Believed(value=loss_s * v, std=0.1 * loss_s * v, source="made")
        for j, v in ideal.stiffness.items()
    }
    return believed_arm(ideal.table, k, c, TOLERANCES)


def with_axis(machine, link, compliance, loss_s):
    """The machine with a skew axis at a link's root, as `added.axis` has it."""
    machine = machine.copy()
    machine.bodies[link].axes.append(
        Axis(
            name="hidden axis",
            direction=np.array(AXIS_DIRECTION),
            at_m=np.array(AXIS_POINT),
            stiffness=1.0 / compliance,
            damping=loss_s / compliance,
        )
    )
    return machine


def move_log(ideal, machine, *, point, turns_rad, move_s=0.5, rest_s=1.0, rate_hz=1000.0):
    """A log of drives that go there and back, each by a bell of speed, from a posture at rest.

    Parameters
    ----------
    turns_rad
        By joint.
    """
    n = int((2.0 * move_s + 3.0 * rest_s) * rate_hz)
    fine = np.arange(STEPS * n) / (STEPS * rate_hz)
    there = _bell((fine - rest_s) / move_s) - _bell((fine - 2.0 * rest_s - move_s) / move_s)
    own = machine.copy()
    own.places = {point: machine.places[point]}
    plant = compiled(own, ideal.by_joint(1), 1.0 / (STEPS * rate_hz))
    model = plant.model
    torque = np.zeros(model.nv)
    for joint, turn in turns_rad.items():
        torque[model.joint(joint).dofadr[0]] = turn
    k = np.array([_spring(model, i) for i in range(model.nv)])
    rate = np.gradient(there, fine)
    # A motor that turns by d behind a spring and a damper pushes by k d + c d'.
    pushes = np.outer(there, k * torque) + np.outer(
        rate, model.dof_damping.reshape(model.nv, -1)[:, 0] * torque
    )
    spec = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros(mujoco.mj_stateSize(model, spec))
    mujoco.mj_getState(model, plant.data, start, spec)
    _, readings = mujoco.rollout.rollout(
        [model],
        [mujoco.MjData(model)],
        start[None],
        pushes[None],
        control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED),
    )
    names = list(ideal.by_joint(1))
    angles = np.tile(ideal.angles(1), (n, 1))
    for joint, turn in turns_rad.items():
        angles[:, names.index(joint)] += turn * there[::STEPS]
    return MotionLog(
        rate_hz=rate_hz,
        slowest_hz=rate_hz,
        encoder_rad=angles,
        command_rad=None,
        acceleration_m_s2={point: readings[0, ::STEPS]},
        unused=(),
    )


def _bell(part):
    """From 0 to 1 with rate and acceleration zero at both ends."""
    x = np.clip(part, 0.0, 1.0)
    return x**3 * (10.0 - 15.0 * x + 6.0 * x**2)


def _spring(model, dof):
    joint = int(model.dof_jntid[dof])
    return float(np.max(np.abs(model.jnt_stiffness[joint])))
