"""A session's hits on a user's MJCF, simulated in time: what its sensors would have recorded.

The driven joints stand still at the measured angles, held by inertia; the springs of the elastic
ones are stretched so that the arm is at rest there. The measured force acts at the point that was
hit; the accelerometer's mass rides on the point that it is mounted at.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.analyzer.export.frames import BodyFrames
from armodal.analyzer.modal.spectra import active_channels
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.errors import EstimateError
from armodal.protocols.session.records import Hit, Session

__all__ = ["HELD", "SimulatedArm", "first_hits", "simulated_session", "standing_model"]

Array = npt.NDArray[np.float64]

HELD = 1e9  # kg m^2 of a driven joint: it does not move
_STABLE = 1.3  # of a fourth-order Runge-Kutta step times omega; beyond 2.8 it is unstable
_FEWEST_STEPS = 8  # a force is even over a step: half of one is a delay
_MOST_STEPS = 128  # of the simulation, a sample
_THREADS = 2
_SENSOR_M = 0.005  # radius of gyration of an accelerometer; next to nothing beside its lever
_NOTHING = 1e-9  # kg, where none is mounted


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedArm:
    """A user's MJCF with an arm's corrections, and how its bodies stand to the arm's links."""

    arm: Arm
    mujoco: Any
    text: str
    folder: Path  # of the user's file: meshes are found from there
    bodies: tuple[str, ...]  # of each joint of the arm
    base: str  # the body before
    frames: BodyFrames
    elastic: tuple[str, ...]


def first_hits(session: Session) -> Session:
    """Return the session with one accepted hit of every posture, mounting and hit point."""
    seen: dict[tuple[str, str, str, tuple[float, ...]], Hit] = {}
    for hit in session.hits:
        if hit.verdict.accepted:
            direction = tuple(np.round(hit.hit_direction, 6).tolist())
            seen.setdefault((hit.posture, hit.sensor_point, hit.hit_point, direction), hit)
    if not seen:
        raise EstimateError(
            "wanted a session with records of hits, got none: its FRFs were averaged elsewhere; "
            "a simulation in time needs the force of single hits"
        )
    return replace(session, hits=tuple(seen.values()))


def simulated_session(session: Session, own: SimulatedArm) -> Session:
    """Return the session with what a simulator's sensors record in the place of the measured.

    Raises
    ------
    EstimateError
        If a spring is too stiff to be followed, or the simulation does not stay finite.
    """
    hits: list[Hit] = []
    for posture in dict.fromkeys(hit.posture for hit in session.hits):
        chosen = [hit for hit in session.hits if hit.posture == posture]
        hits += _of_posture(session, own, chosen)
    return replace(session, hits=tuple(hits))


def _of_posture(session: Session, own: SimulatedArm, hits: list[Hit]) -> list[Hit]:
    mujoco: Any = own.mujoco
    points = {point.id: point for point in own.arm.points}
    sensors = list(dict.fromkeys(hit.sensor_point for hit in hits))
    rate_hz = float(session.header.plan.sampling.rate_hz)
    angles, sensor_kg = _angles(hits), session.header.plan.sensor.mass_kg
    bare, _, n_steps = standing_model(own, sensors, angles, rate_hz)
    mounted = {name: _with_mass(bare, own, angles, name, sensor_kg) for name in sensors}
    force, acceleration, columns = active_channels(session)
    control, starts = [], []
    state = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    for hit in hits:
        model, data = mounted[hit.sensor_point]
        start = np.zeros(mujoco.mj_stateSize(model, state))
        mujoco.mj_getState(model, data, start, state)
        newtons = force.scale * hit.counts[:, columns[0]].astype(np.float64)
        newtons = newtons - np.median(newtons)
        load = _load(mujoco, model, data, own, points[hit.hit_point], hit.hit_direction)
        fine = np.interp(
            np.arange(len(newtons) * n_steps) / n_steps, np.arange(len(newtons)), newtons
        )
        control.append(np.outer(fine, load))
        starts.append(start)
    rollout: Any = import_module("mujoco.rollout")
    longest = max(len(own_control) for own_control in control)
    padded = np.array([np.pad(c, ((0, longest - len(c)), (0, 0))) for c in control])
    _, readings = rollout.rollout(
        [mounted[hit.sensor_point][0] for hit in hits],
        [mujoco.MjData(bare) for _ in range(_THREADS)],
        np.array(starts),
        padded,
        control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED),
    )
    if not np.isfinite(readings).all():
        raise EstimateError(
            f"the simulation of posture '{hits[0].posture}' did not stay finite; look at the model "
            "in MuJoCo's own viewer"
        )
    found = []
    first = int(bare.nsensordata) - 3 * len(sensors)  # the user's own come before
    for hit, of in zip(hits, readings, strict=True):
        at = first + 3 * sensors.index(hit.sensor_point)
        seen = of[: len(hit.counts) * n_steps : n_steps, at : at + 3]
        counts = hit.counts.copy()
        for axis, (channel, column) in enumerate(zip(acceleration, columns[1:], strict=True)):
            counts[:, column] = np.round(seen[:, axis] / channel.scale).astype(counts.dtype)
        found.append(replace(hit, counts=counts))
    return found


def standing_model(
    own: SimulatedArm, sensors: Sequence[str], angles: Array, rate_hz: float
) -> tuple[Any, Any, int]:
    """Return model and data of the arm at rest, accelerometers last, and steps of a sample.

    Raises
    ------
    EstimateError
        If a spring is too stiff to be followed.
    """
    mujoco: Any = own.mujoco
    points = {point.id: point for point in own.arm.points}
    spec = mujoco.MjSpec.from_string(own.text)
    spec.modelfiledir = str(own.folder)
    for name in sensors:
        _add_sensor(mujoco, spec, own, points[name])
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.disableflags = (
        mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_AUTORESET
    )
    model = spec.compile()
    data = mujoco.MjData(model)
    _rest(mujoco, model, data, own, angles)
    n_steps = _steps_of_sample(mujoco, model, data, own, rate_hz)
    model.opt.timestep = 1.0 / (n_steps * rate_hz)
    return model, data, n_steps


def _with_mass(
    bare: Any, own: SimulatedArm, angles: Array, sensor: str, mass_kg: float
) -> tuple[Any, Any]:
    """Model and data of the arm at rest with an accelerometer's mass at one of the points."""
    mujoco: Any = own.mujoco
    model = copy(bare)
    carrier = model.body(_carrier(sensor)).id
    model.body_mass[carrier] = mass_kg
    model.body_inertia[carrier] = mass_kg * _SENSOR_M**2
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    mujoco.mj_resetData(model, data)  # which the constants have moved
    _rest(mujoco, model, data, own, angles)
    return model, data


def _carrier(point: str) -> str:
    return f"armodal_at_{point}"


def _angles(hits: list[Hit]) -> Array:
    read = [
        reading.joints_rad
        for hit in hits
        for reading in (hit.before, hit.after)
        if reading.joints_rad is not None
    ]
    if not read:
        raise EstimateError(f"posture '{hits[0].posture}' has no measured joint angles")
    return np.asarray(np.mean(read, axis=0))


def _place(own: SimulatedArm, point: Point) -> tuple[str, Array, Array]:
    """Body, place and sensor axes of a point, in the body's frame."""
    if point.link == "base":
        body, T = own.base, own.frames.T_body_base
    else:
        link = [joint.link.name for joint in own.arm.joints].index(point.link)
        body, T = own.bodies[link], own.frames.T_body_link[link]
    return body, T[:3, :3] @ point.position_m + T[:3, 3], T[:3, :3] @ point.R_link_sensor


def _add_sensor(mujoco: Any, spec: Any, own: SimulatedArm, point: Point) -> None:
    body, at, R = _place(own, point)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(R).reshape(9))
    holder = spec.worldbody if body == "world" else spec.body(body)
    carrier = holder.add_body(name=_carrier(point.id), pos=at, quat=quat)
    carrier.explicitinertial, carrier.mass = True, _NOTHING
    carrier.ipos, carrier.iquat = np.zeros(3), [1.0, 0.0, 0.0, 0.0]
    carrier.inertia = np.full(3, _NOTHING * _SENSOR_M**2)
    carrier.add_site(name=f"armodal_point_{point.id}")
    spec.add_sensor(
        name=f"armodal_sensor_{point.id}",
        type=mujoco.mjtSensor.mjSENS_ACCELEROMETER,
        objtype=mujoco.mjtObj.mjOBJ_SITE,
        objname=f"armodal_point_{point.id}",
    )


def _rest(mujoco: Any, model: Any, data: Any, own: SimulatedArm, angles: Array) -> None:
    """Put the arm into a posture, hold its drives, and stretch its springs to rest there."""
    for joint, angle in zip(own.arm.joints, angles, strict=True):
        at = model.joint(joint.name)
        data.qpos[at.qposadr[0]] = angle
        model.dof_armature[at.dofadr[0]] = HELD
    model.actuator_gainprm[:] = 0.0
    model.actuator_biasprm[:] = 0.0
    mujoco.mj_forward(model, data)
    for name in own.elastic:
        joint = model.joint(name)
        stiffness = float(np.max(model.jnt_stiffness[joint.id]))
        if stiffness > 0.0:
            load = float(data.qfrc_bias[joint.dofadr[0]])
            model.qpos_spring[joint.qposadr[0]] = load / stiffness
    mujoco.mj_forward(model, data)


def _steps_of_sample(mujoco: Any, model: Any, data: Any, own: SimulatedArm, rate_hz: float) -> int:
    """Steps that the fastest spring needs."""
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    at = [int(model.joint(name).dofadr[0]) for name in own.elastic]
    springs = [float(np.max(model.jnt_stiffness[model.joint(name).id])) for name in own.elastic]
    fastest = float(np.sqrt(scipy.linalg.eigvalsh(np.diag(springs), mass[np.ix_(at, at)])[-1]))
    n_steps = int(np.ceil(fastest / (_STABLE * rate_hz)))
    if n_steps > _MOST_STEPS:
        raise EstimateError(
            f"the fastest spring of the model swings at {fastest / (2.0 * np.pi):.0f} Hz: too fast "
            f"for steps of 1 / {_MOST_STEPS} of a sample; give what hardly gives way no compliance"
        )
    return max(n_steps, _FEWEST_STEPS)


def _load(
    mujoco: Any, model: Any, data: Any, own: SimulatedArm, point: Point, direction: Array
) -> Array:
    """Generalised force of a newton along a direction of the base frame at a point."""
    body, at, _ = _place(own, point)
    i = model.body(body).id
    R = data.xmat[i].reshape(3, 3)
    before = model.body(own.base).id
    to_world = data.xmat[before].reshape(3, 3) @ own.frames.T_body_base[:3, :3]
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, linear, angular, R @ at + data.xpos[i], i)
    return np.asarray(linear.T @ (to_world @ direction))
