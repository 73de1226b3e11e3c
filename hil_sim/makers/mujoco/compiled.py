"""A machine in a posture as a MuJoCo model at rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.mujoco.machine import Body, Machine, Servo, Spring, turned

__all__ = ["Compiled", "compiled", "jacobian"]

# Of a leapfrog step times a mode's angular frequency; beyond 2 it is unstable.
FASTEST = 1.3
# Steps within which a joint that sticks loses its creep, the least MuJoCo takes. Dry friction turns
# round half that long before the joint does.
STICKS = 2.0
STICKS_HOW_WELL = (0.99, 0.999, 0.001, 0.5, 2.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Compiled:
    """Model and data; generalised coordinates are zero at rest."""

    model: mujoco.MjModel
    data: mujoco.MjData


def compiled(
    machine: Machine, joints_rad: Mapping[str, float], step_s: float, *, slowed: bool = False
) -> Compiled:
    """Write and compile the model; springs are stretched so that the posture is at rest.

    Parameters
    ----------
    joints_rad
        True angle of every joint.
    slowed
        Give axes that are no joint's enough inertia that steps of `step_s` can follow them
        (selective mass scaling, Belytschko, Nonlinear Finite Elements, section 6.2).
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = step_s
    spec.option.gravity = machine.gravity_m_s2
    # Speeds half a step off the turns, so forces act when they are told. Runge-Kutta's steps would
    # keep a spring's yield from their first stage: a part of it comes back as work.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags = (
        mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_AUTORESET
    )
    fastest = FASTEST / step_s if slowed else np.inf
    written = {"": spec.worldbody}
    for body in _outwards(machine):
        written[body.name] = _write(
            written[body.parent], body, joints_rad.get(body.joint, 0.0), fastest, STICKS * step_s
        )
    for name, place in machine.places.items():
        site = written[place.body].add_site(name=f"point {name}", pos=place.at_m)
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, place.R_body_sensor.reshape(9))
        site.quat = quat
    for spring in machine.springs:
        _write_spring(spec, written, spring)
    for servo in machine.servos:
        _write_servo(spec, servo)
    for name in machine.places:
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_ACCELEROMETER,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=f"point {name}",
        )
    model = spec.compile()
    data = mujoco.MjData(model)
    _stretch(model, data)
    return Compiled(model=model, data=data)


def jacobian(here: Compiled, body: str, at_m: Array) -> tuple[Array, Array, Array]:
    """Jacobians of a place, (3, nv) linear and angular, and the body's rotation (3, 3)."""
    model, data = here.model, here.data
    i = model.body(body).id
    R = data.xmat[i].reshape(3, 3).copy()
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, linear, angular, R @ at_m + data.xpos[i], i)
    return linear, angular, R


def _outwards(machine: Machine) -> list[Body]:
    """Bodies, each after its parent."""
    ordered: list[Body] = []
    waiting = list(machine.bodies.values())
    known = {""}
    while waiting:
        ready = [body for body in waiting if body.parent in known]
        if not ready:
            raise ValueError(f"bodies without a parent: {[body.name for body in waiting]}")
        ordered += ready
        known |= {body.name for body in ready}
        waiting = [body for body in waiting if body.name not in known]
    return ordered


def _write(
    parent: mujoco.MjsBody, body: Body, angle_rad: float, fastest_rad_s: float, sticks_s: float
) -> mujoco.MjsBody:
    T = body.T_parent_body @ turned(body.drive_axis, angle_rad)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(T[:3, :3]).reshape(9))
    written = parent.add_body(name=body.name, pos=T[:3, 3], quat=quat)
    if body.inertial is not None:
        written.explicitinertial = True
        written.mass = body.inertial.mass_kg
        written.ipos = body.inertial.center_m
        written.fullinertia = body.inertial.inertia_kg_m2
    for axis in body.axes:
        kind = mujoco.mjtJoint.mjJNT_SLIDE if axis.slide else mujoco.mjtJoint.mjJNT_HINGE
        scaled = 0.0 if axis.name == body.joint else axis.stiffness / fastest_rad_s**2
        written.add_joint(
            name=axis.name,
            type=kind,
            axis=axis.direction,
            pos=axis.at_m,
            stiffness=[axis.stiffness, 0.0, 0.0],
            damping=[axis.damping, 0.0, 0.0],
            armature=axis.inertia + scaled,
            frictionloss=axis.coulomb,
            solref_friction=(sticks_s, 1.0),
            solimp_friction=STICKS_HOW_WELL,
        )
    return written


def _write_spring(spec: mujoco.MjSpec, written: dict[str, mujoco.MjsBody], spring: Spring) -> None:
    tendon = spec.add_tendon(
        name=spring.name,
        stiffness=[spring.stiffness, 0.0, spring.cubic],
        damping=[spring.damping, 0.0, 0.0],
        springyield=spring.yields_at,
    )
    if spring.ends is None:
        half = 0.5 * spring.dead_band
        tendon.springlength = [-half, half]
        for axis, coefficient in spring.axes.items():
            tendon.wrap_joint(axis, coefficient)
        return
    if spring.rest_m is not None:
        tendon.springlength = [spring.rest_m, spring.rest_m]
    for i, (body, at_m) in enumerate(spring.ends):
        written[body].add_site(name=f"{spring.name} {i}", pos=at_m)
        tendon.wrap_site(f"{spring.name} {i}")


def _write_servo(spec: mujoco.MjSpec, servo: Servo) -> None:
    actuator = spec.add_actuator(
        name=f"servo {servo.axis}", target=servo.axis, trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    actuator.set_to_position(kp=servo.stiffness, kv=servo.damping)


def _stretch(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Load each axis's spring or servo with what gravity and other springs ask at rest."""
    mujoco.mj_forward(model, data)
    loads = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
    for axis in range(model.njnt):
        stiffness = float(model.jnt_stiffness[axis])
        if stiffness > 0.0:
            model.qpos_spring[model.jnt_qposadr[axis]] = -loads[model.jnt_dofadr[axis]] / stiffness
    for servo in range(model.nu):
        axis = int(model.actuator_trnid[servo, 0])
        model.actuator_biasprm[servo, 0] = -loads[model.jnt_dofadr[axis]]
    mujoco.mj_forward(model, data)
