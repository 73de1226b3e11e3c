"""The machine as plain data: bodies, what turns between them, springs and servos beside them.

Effects edit it; `compiled.py` writes it as a MuJoCo model in a posture.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, field

import mujoco
import numpy as np

from armodal.hil_sim.makers.arm_table import Array, Inertial

__all__ = ["Axis", "Body", "Machine", "Place", "Servo", "Spring", "read_machine", "turned"]

BASE = "base"


@dataclass(slots=True, kw_only=True)
class Axis:
    """A degree of freedom of a body against its parent, from the posture held."""

    name: str
    direction: Array  # (3,) body frame
    at_m: Array  # (3,) body frame
    stiffness: float  # N m/rad, or N/m along a slide
    damping: float
    slide: bool = False
    inertia: float = 0.0  # of what turns with it through a gear, kg m^2
    coulomb: float = 0.0  # N m, dry friction without presliding


@dataclass(slots=True, kw_only=True)
class Body:
    """A rigid body; its frame turns about `drive_axis` by the joint's angle in the posture."""

    name: str
    parent: str  # "" is the floor
    T_parent_body: Array  # (4, 4) at a joint angle of zero
    inertial: Inertial | None
    axes: list[Axis] = field(default_factory=list)
    joint: str = ""  # that moves it; empty for a body of the makers' own
    drive_axis: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))


@dataclass(slots=True, kw_only=True)
class Spring:
    """A tendon: over axes with their coefficients, or straight between two places."""

    name: str
    axes: dict[str, float] = field(default_factory=dict)
    ends: tuple[tuple[str, Array], tuple[str, Array]] | None = None  # body, (3,) its frame
    stiffness: float = 0.0
    cubic: float = 0.0  # force over stretch to the third
    damping: float = 0.0
    dead_band: float = 0.0  # rad, whole width
    yields_at: float = 0.0  # rad or m of stretch; 0 never
    rest_m: float | None = None  # length unstressed; None: that of the posture


@dataclass(slots=True, kw_only=True)
class Servo:
    """Position servo of an axis, which has no spring of its own then."""

    axis: str
    stiffness: float  # N m/rad
    damping: float  # N m s/rad


@dataclass(slots=True, kw_only=True)
class Place:
    """Where a point truly is, and how the sensor there stands."""

    body: str
    at_m: Array  # (3,) body frame
    R_body_sensor: Array  # (3, 3)


@dataclass(slots=True, kw_only=True)
class Machine:
    """All of it."""

    bodies: dict[str, Body]
    places: dict[str, Place] = field(default_factory=dict)
    springs: list[Spring] = field(default_factory=list)
    servos: list[Servo] = field(default_factory=list)
    gravity_m_s2: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.80665]))

    def copy(self) -> Machine:
        """Return a machine of its own."""
        return copy.deepcopy(self)

    def axis(self, name: str) -> Axis:
        """Return the axis of that name."""
        return next(a for body in self.bodies.values() for a in body.axes if a.name == name)

    def moved_by(self, joint: str) -> Body:
        """Return the body that a joint moves."""
        return next(body for body in self.bodies.values() if body.joint == joint)

    @property
    def nonlinear(self) -> bool:
        """Whether hits have to be simulated in time one by one."""
        bent = any(s.cubic or s.dead_band or s.yields_at for s in self.springs)
        dry = any(axis.coulomb for body in self.bodies.values() for axis in body.axes)
        return bent or dry


def read_machine(text: str) -> Machine:
    """Read a serial arm from URDF or MJCF, with MuJoCo's own reader.

    The first body is the base, wherever the file puts it. Each body that a hinge moves is a link;
    bodies without one are merged into their parents.
    """
    spec = mujoco.MjSpec.from_string(text)
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    poses = [_pose(data.xpos[i], data.xmat[i]) for i in range(model.nbody)]
    bodies = {BASE: Body(name=BASE, parent="", T_parent_body=np.eye(4), inertial=None)}
    owner, frames = {0: BASE}, {BASE: np.eye(4)}
    for i in range(1, model.nbody):
        name, parent = model.body(i).name, owner[int(model.body_parentid[i])]
        inertial = _inertial(model, i)
        if model.body_jntnum[i] == 0:
            owner[i] = parent
            shift = np.linalg.inv(frames[parent]) @ poses[i]
            if inertial.mass_kg > 0.0:
                body = _moved(inertial, shift)
                own = bodies[parent].inertial
                bodies[parent].inertial = body if own is None else own.with_body(body)
            continue
        joint = model.joint(int(model.body_jntadr[i]))
        owner[i], frames[name] = name, poses[i]
        bodies[name] = Body(
            name=name,
            parent=parent,
            T_parent_body=np.linalg.inv(frames[parent]) @ poses[i],
            inertial=inertial,
            joint=joint.name,
            drive_axis=np.array(joint.axis),
        )
    return Machine(bodies=bodies)


def turned(axis: Array, angle_rad: float) -> Array:
    """Transform, (4, 4), of a turn about an axis through the origin."""
    quat, flat = np.zeros(4), np.zeros(9)
    mujoco.mju_axisAngle2Quat(quat, axis, angle_rad)
    mujoco.mju_quat2Mat(flat, quat)
    return _pose(np.zeros(3), flat)


def _pose(position: Array, flat: Array) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.reshape(flat, (3, 3)), position
    return T


def _inertial(model: mujoco.MjModel, i: int) -> Inertial:
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, model.body_iquat[i])
    R = flat.reshape(3, 3)
    return Inertial.of(
        float(model.body_mass[i]), model.body_ipos[i], R @ np.diag(model.body_inertia[i]) @ R.T
    )


def _moved(body: Inertial, T: Array) -> Inertial:
    R = T[:3, :3]
    center = R @ np.array(body.center_m) + T[:3, 3]
    return Inertial.of(body.mass_kg, center, R @ body.matrix() @ R.T)
