"""MJCF by MuJoCo's own compiler: defaults, includes, frames and inertias as it resolves them."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.apart import apart, bytes_allowed
from armodal.protocols.errors import ArmError, MissingPackageError
from armodal.protocols.robot.records import Inertial, Robot, RobotJoint, RobotLink, Shape
from armodal.protocols.robot.remarks import Remarks

__all__ = ["compiled_mjcf", "prepare", "read_mjcf", "tried"]

Array = npt.NDArray[np.float64]

_LONGEST = 300


def read_mjcf(path: Path, said: Remarks) -> Robot | None:
    """Read the bodies of an MJCF file as links.

    Raises
    ------
    MissingPackageError
        If MuJoCo is not installed.
    """
    try:
        mujoco, model = compiled_mjcf(path)
    except ArmError as problem:
        said.fault("file", str(problem))
        return None
    names = ["world" if i == 0 else model.body(i).name or f"body_{i}" for i in range(model.nbody)]
    if len(set(names)) < len(names):
        said.fault("bodies", "wanted body names that differ")
    links = {name: _link(mujoco, model, i, name) for i, name in enumerate(names)}
    joints = [_joint(mujoco, model, i, names, said) for i in range(1, model.nbody)]
    return Robot(name=path.stem, links=links, joints=tuple(joints))


def compiled_mjcf(path: Path) -> tuple[Any, Any]:
    """Return MuJoCo and the model of a file, once that has been seen to stay within bounds.

    Raises
    ------
    MissingPackageError
        If MuJoCo is not installed.
    ArmError
        If the file does not compile, or takes more than it may.
    """
    mujoco = _mujoco(path)
    try:
        text = path.read_text("utf-8", "replace")
    except OSError as problem:
        raise ArmError(f"{path.name}: wanted an MJCF, it cannot be read") from problem
    where = f"{__name__}:tried"
    if said := apart(where, {"path": str(path)}, most_bytes=bytes_allowed(text), what=path.name):
        raise ArmError(said)
    return mujoco, mujoco.MjModel.from_xml_path(str(path))


def prepare() -> None:
    """Load the package, which takes memory of its own."""
    with suppress(ImportError):
        import_module("mujoco")


def tried(path: str) -> str:
    """Return why a file does not compile; empty if it does."""
    try:
        _mujoco(Path(path)).MjModel.from_xml_path(path)
    except (ValueError, RuntimeError, OSError, MemoryError) as problem:
        return f"wanted an MJCF that compiles, got: {_short(problem) or type(problem).__name__}"
    return ""


def _mujoco(path: Path) -> Any:
    try:
        return import_module("mujoco")
    except ImportError as problem:
        raise MissingPackageError(
            f"wanted the package mujoco-core for {path.name}, it is not installed; install it "
            "with `pip install 'armodal[robots]'`"
        ) from problem


def _short(problem: Exception) -> str:
    return " ".join(str(problem).split())[:_LONGEST]


def _link(mujoco: Any, model: Any, body: int, name: str) -> RobotLink:
    shift = _joint_place(model, body)
    mass = float(model.body_mass[body])
    inertial = None
    if mass > 0.0:
        R = _rotation(mujoco, model.body_iquat[body])
        inertial = Inertial(
            mass_kg=mass,
            center_m=np.array(model.body_ipos[body]) - shift,
            inertia_kg_m2=R @ np.diag(model.body_inertia[body]) @ R.T,
        )
    visual: list[Shape] = []
    collision: list[Shape] = []
    first = int(model.body_geomadr[body])
    for geom in range(first, first + int(model.body_geomnum[body])):
        shape = _shape(mujoco, model, geom, shift)
        if shape is not None:
            seen_only = not model.geom_contype[geom] and not model.geom_conaffinity[geom]
            (visual if seen_only else collision).append(shape)
    return RobotLink(name=name, inertial=inertial, visual=tuple(visual), collision=tuple(collision))


def _shape(mujoco: Any, model: Any, geom: int, shift: Array) -> Shape | None:
    T = np.eye(4)
    T[:3, :3] = _rotation(mujoco, model.geom_quat[geom])
    T[:3, 3] = np.array(model.geom_pos[geom]) - shift
    kinds, size = mujoco.mjtGeom, [float(value) for value in model.geom_size[geom]]
    kind = model.geom_type[geom]
    if kind == kinds.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        v, n = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        f, m = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        return Shape(
            kind="triangles",
            size_m=(),
            T_link_shape=T,
            vertices_m=np.array(model.mesh_vert[v : v + n], dtype=np.float64),
            triangles=np.array(model.mesh_face[f : f + m], dtype=np.int64),
        )
    if kind == kinds.mjGEOM_BOX:
        return Shape(kind="box", size_m=tuple(2.0 * value for value in size), T_link_shape=T)
    if kind == kinds.mjGEOM_SPHERE:
        return Shape(kind="sphere", size_m=(size[0],), T_link_shape=T)
    for number, name in ((kinds.mjGEOM_CYLINDER, "cylinder"), (kinds.mjGEOM_CAPSULE, "capsule")):
        if kind == number:
            return Shape(kind=name, size_m=(size[0], 2.0 * size[1]), T_link_shape=T)
    return None


def _joint(mujoco: Any, model: Any, body: int, names: list[str], said: Remarks) -> RobotJoint:
    number, first = int(model.body_jntnum[body]), int(model.body_jntadr[body])
    parent = int(model.body_parentid[body])
    T = np.eye(4)
    T[:3, :3] = _rotation(mujoco, model.body_quat[body])
    here = np.array(model.body_pos[body]) - _joint_place(model, parent)
    T[:3, 3] = here + T[:3, :3] @ _joint_place(model, body)
    kind, axis, limits = "fixed", np.array([0.0, 0.0, 1.0]), None
    name = f"{names[body]} fixed"
    if number > 1:
        said.fault(f"body {names[body]}", f"wanted at most one joint, got {number}")
    elif number == 1:
        kinds = mujoco.mjtJoint
        name = model.joint(first).name or f"{names[body]} joint"
        axis = np.array(model.jnt_axis[first], dtype=np.float64)
        limited = bool(model.jnt_limited[first])
        if model.jnt_type[first] == kinds.mjJNT_HINGE:
            kind = "revolute" if limited else "continuous"
        elif model.jnt_type[first] == kinds.mjJNT_SLIDE:
            kind = "prismatic"
        else:
            kind = "floating"
        if limited:
            limits = (float(model.jnt_range[first][0]), float(model.jnt_range[first][1]))
    return RobotJoint(
        name=name,
        kind=kind,
        parent=names[parent],
        child=names[body],
        T_parent_joint=T,
        axis=axis,
        range_rad=limits,
    )


def _joint_place(model: Any, body: int) -> Array:
    """Where a body's joint is in its own frame: here a link's frame stands in its joint."""
    if body == 0 or int(model.body_jntnum[body]) == 0:
        return np.zeros(3)
    return np.array(model.jnt_pos[int(model.body_jntadr[body])], dtype=np.float64)


def _rotation(mujoco: Any, quaternion: Array) -> Array:
    nine = np.zeros(9)
    mujoco.mju_quat2Mat(nine, np.asarray(quaternion, dtype=np.float64))
    return nine.reshape(3, 3)
