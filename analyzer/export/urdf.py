"""A corrected arm as URDF: the user's own file with joints put in, or one from the arm file.

URDF has dampers (`dynamics`) and no springs. Those stand in Gazebo's own tags, which its conversion
to SDF reads: `springStiffness` and `springReference` under `gazebo`.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

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
from armodal.analyzer.export.tree import Freedom, Tree, TreeBody
from armodal.protocols.arm.records import Arm
from armodal.protocols.arm.urdf import parsed_with_comments, read_urdf
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.read import MOST_DESCRIPTION_BYTES
from armodal.protocols.toml_reader import read_text

__all__ = ["patched_urdf", "urdf_text"]

Array = npt.NDArray[np.float64]

_ROOT = "armodal_ground"
_SAME = 1e-6  # m and rotation matrix: the same chain
_NOTE = (
    "URDF has no springs: they are in Gazebo's tags springStiffness and springReference, which "
    "other readers pass over"
)


def urdf_text(arm: Arm, tree: Tree) -> tuple[str, tuple[str, ...]]:
    """Return an arm as URDF without meshes, and what to know of it.

    Raises
    ------
    ArmError
        If something has no counterpart in URDF.
    """
    refuse_without_counterpart(arm, tree, "URDF")
    root = ET.Element("robot", name=arm.name)
    if tree.bodies[0].link >= 0:
        ET.SubElement(root, "link", name="base")
    elif tree.bodies[0].freedoms:
        ET.SubElement(root, "link", name=_ROOT)
    for body in tree.bodies:
        if body.link < 0 and not body.freedoms:
            root.append(
                _link(
                    Step(
                        parent="", link=body.name, T_parent_link=np.eye(4), freedom=None, body=body
                    )
                )
            )
            continue
        for step in _steps(body, "base"):
            root.append(_link(step))
            root.append(_joint(step))
    root.extend(_springs(tree))
    return '<?xml version="1.0"?>\n' + _text(root), (_NOTE,)


def patched_urdf(arm: Arm, tree: Tree, source: Path | None) -> tuple[str, tuple[str, ...]]:
    """Return the user's URDF with the arm's corrections: meshes, names and the rest stay.

    Parameters
    ----------
    source
        The file; None for the URDF that the arm file names.

    Raises
    ------
    ArmError
        If something has no counterpart in URDF, or the file is not of this arm.
    """
    refuse_without_counterpart(arm, tree, "URDF")
    origin = "the arm file's URDF" if source is None else str(source)
    text = arm.urdf_text or ""
    if source is not None:
        text = read_text(source, what="URDF", limit_bytes=MOST_DESCRIPTION_BYTES, error=ArmError)
    head, root = parsed_with_comments(text)
    base = _base_of_same_arm(arm, text, origin)
    joints = {str(own.get("name")): own for own in root.findall("joint")}
    links = {str(own.get("name")): own for own in root.findall("link")}
    _refuse_taken(tree, joints, links, origin)
    riding = _without_mass(arm, root, links)
    _put_in(arm, tree, root, joints, links, base)
    if tree.bodies[0].link < 0 and tree.bodies[0].freedoms:
        root.insert(0, ET.Element("link", name=_ROOT))
    root.extend(_springs(tree))
    notes = [_NOTE, "masses, centres and inertias of the arm's links are those of the arm file"]
    if riding:
        notes.append(f"in the masses of the links they ride on: {', '.join(riding)}")
    return head + _text(root), tuple(notes)


def _put_in(
    arm: Arm,
    tree: Tree,
    root: ET.Element,
    joints: dict[str, ET.Element],
    links: dict[str, ET.Element],
    base: str,
) -> None:
    """Put the corrections' joints and links between the file's own."""
    last_of: dict[str | None, str] = {}
    for body in tree.bodies:
        if body.link < 0 and not body.freedoms:
            continue
        for step in _steps(body, base):
            link = _link(step)
            if step.link in links:
                _replace_inertial(links[step.link], link)
            else:
                root.append(link)
            if step.freedom is None or not step.freedom.driven:
                root.append(_joint(step))
                continue
            for own in joints[step.freedom.name]:
                if own.tag == "child":
                    own.set("link", step.link)
                if own.tag == "parent" and own.get("link") in last_of:
                    own.set("link", last_of[own.get("link")])
        name = base if body.link < 0 else arm.joints[body.link].link.name
        last_of[name] = name if body.link < 0 else body.name


def _refuse_taken(
    tree: Tree, joints: dict[str, ET.Element], links: dict[str, ET.Element], origin: str
) -> None:
    taken = sorted(
        name
        for body in tree.bodies
        for step in steps_of(body)
        for name in (step.link, "" if step.freedom is None else step.freedom.name)
        if (name in links and step.body is None)
        or (name in joints and step.freedom is not None and not step.freedom.driven)
    )
    if taken:
        raise ArmError(
            f"{origin}: wanted names free for the corrections, got {', '.join(taken)} already there"
        )


def _base_of_same_arm(arm: Arm, text: str, origin: str) -> str:
    """Return the name of a file's first link, and refuse one of another arm."""
    chain = read_urdf(text, replaced=[joint.link.name for joint in arm.joints])
    for what, wanted, got in (
        ("joints", [j.name for j in arm.joints], [j.name for j in chain.joints]),
        ("links", [j.link.name for j in arm.joints], [j.link_name for j in chain.joints]),
    ):
        if wanted != got:
            raise ArmError(
                f"{origin}: wanted the {what} {', '.join(wanted)} of arm '{arm.name}', got "
                f"{', '.join(got)}; give the URDF of this arm"
            )
    for own, other in zip(arm.joints, chain.joints, strict=True):
        same = np.allclose(own.T_parent_joint, other.T_parent_joint, atol=_SAME)
        if not same or not np.allclose(own.axis, other.axis, atol=_SAME):
            raise ArmError(
                f"{origin}: wanted {own.name} where arm '{arm.name}' has it, it is elsewhere; give "
                "the URDF of this arm"
            )
    return chain.base


def _steps(body: TreeBody, base: str) -> Iterator[Step]:
    """Joints of a body, its base and what that stands on by their names in the file."""
    for step in steps_of(body):
        parent = step.parent or (_ROOT if body.link < 0 else base)
        link = step.link
        if body.link < 0 or not body.parent:
            parent, link = (base if name == "base" else name for name in (parent, link))
        yield replace(step, parent=base if step.parent == "base" else parent, link=link)


def _without_mass(arm: Arm, root: ET.Element, links: dict[str, ET.Element]) -> list[str]:
    """Take the mass from links that ride on others: the arm file's links hold it."""
    moved = {joint.link.name for joint in arm.joints}
    riding = []
    for joint in root.findall("joint"):
        child = joint.find("child")
        name = "" if child is None else str(child.get("link"))
        inertial = links[name].find("inertial") if name in links else None
        if joint.get("type") == "fixed" and name not in moved and inertial is not None:
            links[name].remove(inertial)
            riding.append(name)
    return riding


def _replace_inertial(link: ET.Element, own: ET.Element) -> None:
    inertial = own.find("inertial")
    if inertial is None:
        return
    for old in link.findall("inertial"):
        link.remove(old)
    link.insert(0, inertial)


def _link(step: Step) -> ET.Element:
    link = ET.Element("link", name=step.link)
    inertial = ET.SubElement(link, "inertial")
    if step.body is None or step.body.mass_kg <= 0.0:
        mass, center, J = LIGHT_KG, np.zeros(3), LIGHT_KG_M2 * np.eye(3)
    else:
        mass, center, J = step.body.mass_kg, step.body.center_m, step.body.inertia_kg_m2
    ET.SubElement(inertial, "origin", xyz=_numbers(center), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=repr(float(mass)))
    six = {f"i{a}{b}": repr(float(J[i, j])) for (a, i), (b, j) in _SIX}
    ET.SubElement(inertial, "inertia", six)
    return link


_AXES = (("x", 0), ("y", 1), ("z", 2))
_SIX = [(a, b) for n, a in enumerate(_AXES) for b in _AXES[n:]]


def _joint(step: Step) -> ET.Element:
    freedom = step.freedom
    name = f"{step.link}_fixed" if freedom is None else freedom.name
    joint = ET.Element("joint", name=name, type=_type(freedom))
    ET.SubElement(joint, "parent", link=step.parent)
    ET.SubElement(joint, "child", link=step.link)
    T = step.T_parent_link
    rpy = scipy.spatial.transform.Rotation.from_matrix(T[:3, :3]).as_euler("xyz")
    ET.SubElement(joint, "origin", xyz=_numbers(T[:3, 3]), rpy=_numbers(rpy))
    if freedom is None:
        return joint
    ET.SubElement(joint, "axis", xyz=_numbers(freedom.axis))
    if freedom.driven:
        low, high = freedom.range_rad or (-np.pi, np.pi)
        ET.SubElement(
            joint, "limit", lower=repr(low), upper=repr(high), effort="1000", velocity="10"
        )
    else:
        if freedom.slides:
            ET.SubElement(joint, "limit", lower="-0.1", upper="0.1", effort="1e9", velocity="1e3")
        ET.SubElement(joint, "dynamics", damping=repr(freedom.damping), friction="0")
    return joint


def _type(freedom: Freedom | None) -> str:
    if freedom is None:
        return "fixed"
    if freedom.slides:
        return "prismatic"
    return "revolute" if freedom.driven else "continuous"


def _springs(tree: Tree) -> Iterator[ET.Element]:
    for body in tree.bodies:
        for freedom in body.freedoms:
            if freedom.driven:
                continue
            gazebo = ET.Element("gazebo", reference=freedom.name)
            ET.SubElement(gazebo, "springStiffness").text = repr(freedom.stiffness)
            ET.SubElement(gazebo, "springReference").text = "0"
            yield gazebo


def _numbers(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
