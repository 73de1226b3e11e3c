"""A corrected arm as SDF: joints with springs (`axis/dynamics/spring_stiffness`) and dampers.

SDFormat specification 1.9, elements `joint` and `link`.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.export.single_joints import (
    LIGHT_KG,
    LIGHT_KG_M2,
    Step,
    refuse_without_counterpart,
    steps_of,
)
from armodal.analyzer.export.tree import Tree
from armodal.protocols.arm.records import Arm

__all__ = ["sdf_text"]

Array = npt.NDArray[np.float64]

_VERSION = "1.9"
_PAIRS = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))


def sdf_text(arm: Arm, tree: Tree) -> tuple[str, tuple[str, ...]]:
    """Return an arm as SDF without meshes, and what to know of it.

    Raises
    ------
    ArmError
        If something has no counterpart in SDF.
    """
    refuse_without_counterpart(arm, tree, "SDF")
    root = ET.Element("sdf", version=_VERSION)
    model = ET.SubElement(root, "model", name=arm.name)
    has_base = tree.bodies[0].link < 0
    if not has_base:
        base = ET.SubElement(model, "link", name="base")
        _inertial(base, LIGHT_KG, np.zeros(3), LIGHT_KG_M2 * np.eye(3))
        _joint_of(model, "base_on_ground", "fixed", "world", "base")
    for body in tree.bodies:
        if not body.freedoms:
            _link(
                model,
                Step(parent="", link=body.name, T_parent_link=np.eye(4), freedom=None, body=body),
            )
            _joint_of(model, "base_on_ground", "fixed", "world", body.name)
            continue
        for step in steps_of(body):
            parent = step.parent or ("world" if body.link < 0 else "base")
            _link(model, step, parent)
            _joint(model, step, parent)
    notes = (
        "meshes are not in the SDF; convert the patched URDF with Gazebo where they are wanted",
    )
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n", notes


def _link(model: ET.Element, step: Step, parent: str = "world") -> None:
    link = ET.SubElement(model, "link", name=step.link)
    T = step.T_parent_link
    rpy = scipy.spatial.transform.Rotation.from_matrix(T[:3, :3]).as_euler("xyz")
    pose = ET.SubElement(link, "pose")
    if parent != "world":
        pose.set("relative_to", parent)
    pose.text = _numbers(np.concatenate([T[:3, 3], rpy]))
    if step.body is None or step.body.mass_kg <= 0.0:
        _inertial(link, LIGHT_KG, np.zeros(3), LIGHT_KG_M2 * np.eye(3))
    else:
        _inertial(link, step.body.mass_kg, step.body.center_m, step.body.inertia_kg_m2)


def _inertial(link: ET.Element, mass: float, center: Array, J: Array) -> None:
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "pose").text = _numbers(np.concatenate([center, np.zeros(3)]))
    ET.SubElement(inertial, "mass").text = repr(float(mass))
    inertia = ET.SubElement(inertial, "inertia")
    for name, i, j in _PAIRS:
        ET.SubElement(inertia, name).text = repr(float(J[i, j]))


def _joint_of(model: ET.Element, name: str, kind: str, parent: str, child: str) -> ET.Element:
    joint = ET.SubElement(model, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent").text = parent
    ET.SubElement(joint, "child").text = child
    return joint


def _joint(model: ET.Element, step: Step, parent: str) -> None:
    freedom = step.freedom
    if freedom is None:
        _joint_of(model, f"{step.link}_fixed", "fixed", parent, step.link)
        return
    kind = "prismatic" if freedom.slides else "revolute"
    joint = _joint_of(model, freedom.name, kind, parent, step.link)
    axis = ET.SubElement(joint, "axis")
    ET.SubElement(axis, "xyz").text = _numbers(freedom.axis)
    limit = ET.SubElement(axis, "limit")
    low, high = freedom.range_rad if freedom.range_rad is not None else (-1e16, 1e16)
    ET.SubElement(limit, "lower").text = repr(float(low))
    ET.SubElement(limit, "upper").text = repr(float(high))
    if not freedom.driven:
        dynamics = ET.SubElement(axis, "dynamics")
        ET.SubElement(dynamics, "damping").text = repr(freedom.damping)
        ET.SubElement(dynamics, "friction").text = "0"
        ET.SubElement(dynamics, "spring_reference").text = "0"
        ET.SubElement(dynamics, "spring_stiffness").text = repr(freedom.stiffness)


def _numbers(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)
