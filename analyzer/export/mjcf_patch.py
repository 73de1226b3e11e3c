"""A corrected arm put into somebody's own MJCF: meshes, names and everything else stay."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.export.frames import body_frames
from armodal.analyzer.export.mjcf import (
    DRIVE_ARMATURE,
    between_elements,
    inertial_element,
    joint_element,
    rotor_element,
)
from armodal.analyzer.export.tree import Freedom, Tree, TreeBody
from armodal.protocols.arm.records import Arm
from armodal.protocols.arm.urdf import parsed_with_comments
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.mjcf import compiled_mjcf
from armodal.protocols.robot.read import MOST_DESCRIPTION_BYTES
from armodal.protocols.toml_reader import read_text

__all__ = ["link_bodies", "patched_mjcf"]

Array = npt.NDArray[np.float64]

_PATHS = ("meshdir", "texturedir", "assetdir")


def patched_mjcf(
    arm: Arm, tree: Tree, source: Path, out: Path, mujoco: Any
) -> tuple[str, tuple[str, ...]]:
    """Return the text of a user's MJCF with the arm's corrections, and what to know of it.

    Parameters
    ----------
    out
        Where the text will stand: paths of meshes are told from there.
    mujoco
        The package.

    Raises
    ------
    ArmError
        If the file is none that MuJoCo loads, closes a loop, lacks joints of the arm or has them in
        another order or place, includes other files from another folder, or uses a name that the
        corrections need; all of a kind are named.
    """
    head, root, model = _read(source)
    parents = {child: parent for parent in root.iter() for child in parent}
    elements = _link_elements(arm, root, parents, source)
    _refuse_loops(root, source)
    _refuse_taken(root, tree, source)
    _move_paths(root, source, out)
    before = parents[elements[0]]
    frames = body_frames(
        arm, mujoco, model, [own.get("name", "") for own in elements], before.get("name", "world")
    )
    base = [body for body in tree.bodies if body.link < 0]
    if base and (base[0].freedoms or base[0].mass_kg > 0.0):
        _put_base(base[0], before, elements[0], frames.T_body_base)
    for link, element in enumerate(elements):
        own = [body for body in tree.bodies if body.link == link]
        following = elements[link + 1] if link + 1 < len(elements) else None
        _put_link(own, element, following, frames.T_body_link[link])
        _arm_drive(element, arm.joints[link].name, model)
    world = root.find("worldbody")
    for rotor in tree.rotors:
        if world is not None:
            world.append(rotor_element(rotor))
    tendons = list(between_elements(tree.between))
    if tendons:
        holder = root.find("tendon")
        (ET.SubElement(root, "tendon") if holder is None else holder).extend(tendons)
    ET.indent(root)
    return head + ET.tostring(root, encoding="unicode") + "\n", tuple(_notes(arm, model, elements))


def link_bodies(arm: Arm, source: Path) -> tuple[tuple[str, ...], str]:
    """Return the body of each joint of the arm in a user's MJCF, and the one before the first.

    Raises
    ------
    ArmError
        As `patched_mjcf`.
    """
    _, root, _ = _read(source)
    parents = {child: parent for parent in root.iter() for child in parent}
    elements = _link_elements(arm, root, parents, source)
    names = tuple(own.get("name", "") for own in elements)
    return names, parents[elements[0]].get("name", "world")


def _read(source: Path) -> tuple[str, ET.Element, Any]:
    text = read_text(source, what="MJCF", limit_bytes=MOST_DESCRIPTION_BYTES, error=ArmError)
    try:
        head, root = parsed_with_comments(text)
    except ArmError as problem:
        raise ArmError(f"{source}: {problem}") from problem
    if root.tag != "mujoco":
        raise ArmError(
            f"{source}: wanted an MJCF file, which begins with <mujoco>, got <{root.tag}>"
        )
    try:
        _, model = compiled_mjcf(source)
    except ArmError as problem:
        raise ArmError(
            f"{source}: wanted a model that MuJoCo loads, it does not; open it in MuJoCo's own "
            "viewer, which says why, and check that its meshes are there"
        ) from problem
    return head, root, model


def _link_elements(
    arm: Arm, root: ET.Element, parents: dict[ET.Element, ET.Element], source: Path
) -> list[ET.Element]:
    """The body of each joint of the arm, in the arm's order."""
    by_name = {j.get("name"): j for j in root.iter("joint") if _is_of_body(j, parents)}
    missing = [joint.name for joint in arm.joints if joint.name not in by_name]
    if missing:
        named = sorted(name for name in by_name if name)
        unnamed = sum(not j.get("name") for j in root.iter("joint") if _is_of_body(j, parents))
        raise ArmError(
            f"{source}: wanted the joints {', '.join(missing)} of arm '{arm.name}', got "
            f"{', '.join(named) or 'none with a name'}"
            + (f" and {unnamed} without a name" if unnamed else "")
            + "; name them as the arm file does (joints of included files are not seen)"
        )
    bodies = [parents[by_name[joint.name]] for joint in arm.joints]
    several = [
        joint.name
        for joint, body in zip(arm.joints, bodies, strict=True)
        if len([*body.findall("joint"), *body.findall("freejoint")]) > 1
    ]
    if several:
        raise ArmError(
            f"{source}: wanted bodies with one joint each, got more beside {', '.join(several)}; "
            "give the model as it was before the corrections"
        )
    for joint, inner, outer in zip(arm.joints[1:], bodies[1:], bodies, strict=False):
        if outer not in _above(inner, parents):
            order = [name for name in by_name if name in {j.name for j in arm.joints}]
            raise ArmError(
                f"{source}: wanted the joints in the order "
                f"{', '.join(j.name for j in arm.joints)} from the base outwards, got "
                f"{', '.join(str(name) for name in order)}: {joint.name} does not hang on the "
                "one before it"
            )
    unnamed_bodies = [
        joint.name for joint, body in zip(arm.joints, bodies, strict=True) if not body.get("name")
    ]
    if unnamed_bodies:
        raise ArmError(
            f"{source}: wanted names of the bodies of {', '.join(unnamed_bodies)}, got none"
        )
    return bodies


def _is_of_body(joint: ET.Element, parents: dict[ET.Element, ET.Element]) -> bool:
    return parents[joint].tag == "body"


def _above(element: ET.Element, parents: dict[ET.Element, ET.Element]) -> Iterator[ET.Element]:
    while element in parents:
        element = parents[element]
        yield element


def _refuse_loops(root: ET.Element, source: Path) -> None:
    loops = [
        own.get("name") or f"{own.tag} without a name"
        for equality in root.findall("equality")
        for own in equality
        if own.tag in ("connect", "weld")
    ]
    if loops:
        raise ArmError(
            f"{source}: wanted an open chain, got loops closed by {', '.join(loops)}; the arm file "
            "describes a serial arm"
        )


def _refuse_taken(root: ET.Element, tree: Tree, source: Path) -> None:
    own = {f.name for body in tree.bodies for f in body.freedoms if not f.driven}
    own |= {rotor.freedom.name for rotor in tree.rotors} | {b.name for b in tree.between}
    taken = sorted(own & {str(element.get("name")) for element in root.iter()})
    if taken:
        raise ArmError(
            f"{source}: wanted names free for the corrections, got {', '.join(taken)} already "
            "there; give the model as it was before the corrections"
        )


def _move_paths(root: ET.Element, source: Path, out: Path) -> None:
    here, there = source.resolve().parent, out.resolve().parent
    if here == there:
        return
    if root.find(".//include") is not None:
        raise ArmError(
            f"{out}: wanted a place beside {source}, which includes other files, got another "
            "folder; write it there"
        )
    compiler = root.find("compiler")
    if compiler is None:
        compiler = ET.Element("compiler")
        root.insert(0, compiler)
    given = {key: compiler.get(key) for key in _PATHS if compiler.get(key) is not None}
    for key in given or ("meshdir", "texturedir"):
        compiler.set(key, os.path.relpath(here / (given.get(key) or ""), there))


def _put_base(body: TreeBody, before: ET.Element, first: ET.Element, T: Array) -> None:
    """Give the base its freedoms; one that is the world itself gets a body of its own."""
    if before.tag == "worldbody":
        holder = ET.Element("body", name="armodal_base")
        at = list(before).index(first)
        before.remove(first)
        before.insert(at, holder)
        holder.append(first)
        before = holder
    before.set("gravcomp", "1")  # the arm's equations leave its weight out
    _put(replace(body, **_moved(body, T)), before)


def _put_link(
    pieces: list[TreeBody], element: ET.Element, following: ET.Element | None, T: Array
) -> None:
    whole, *beyond = (replace(body, **_moved(body, T)) for body in pieces)
    holder = _holder_of(element, following)
    _put(whole, element)
    last = element
    for piece in beyond:
        nested = ET.SubElement(last, "body", name=piece.name)
        _put(piece, nested)
        last = nested
    if last is not element and holder is not None:
        element.remove(holder)
        last.append(holder)


def _holder_of(element: ET.Element, following: ET.Element | None) -> ET.Element | None:
    """The child that holds the next link: itself, or a body fixed between."""
    return next(
        (own for own in element if following is not None and following in set(own.iter())), None
    )


def _put(body: TreeBody, element: ET.Element) -> None:
    """Put freedoms behind the joint a body has, and its inertia in the place of the old one."""
    for old in element.findall("inertial"):
        element.remove(old)
    joints = element.findall("joint")
    at = list(element).index(joints[-1]) + 1 if joints else 0
    new = [joint_element(f) for f in body.freedoms if not f.driven]
    if body.mass_kg > 0.0:
        new.insert(0, inertial_element(body))
    for number, own in enumerate(new):
        element.insert(at + number, own)


def _moved(body: TreeBody, T: Array) -> dict[str, Any]:
    """A body's fields seen from another frame, T the old one's pose in it."""
    R, p = T[:3, :3], T[:3, 3]

    def line(freedom: Freedom) -> Freedom:
        return replace(freedom, axis=R @ freedom.axis, point_m=R @ freedom.point_m + p)

    return {
        "freedoms": tuple(line(f) for f in body.freedoms),
        "center_m": R @ body.center_m + p,
        "inertia_kg_m2": R @ body.inertia_kg_m2 @ R.T,
    }


def _arm_drive(element: ET.Element, name: str, model: Any) -> None:
    """A driven joint without inertia of its own makes the mass matrix singular beside its twin."""
    joint = next(own for own in element.findall("joint") if own.get("name") == name)
    if float(model.dof_armature[model.joint(name).dofadr[0]]) <= 0.0:
        joint.set("armature", repr(DRIVE_ARMATURE))


def _notes(arm: Arm, model: Any, elements: list[ET.Element]) -> Iterator[str]:
    yield "masses, centres and inertias of the arm's links are those of the arm file"
    links = {own.get("name") for own in elements}
    riding = []
    for body in range(1, model.nbody):
        name = model.body(body).name
        if name not in links and model.body_dofnum[body] == 0 and model.body_mass[body] > 0.0:
            root: int = int(model.body_weldid[body])
            if model.body(root).name in links:
                riding.append(f"{name} ({model.body_mass[body]:.3g} kg)")
    if riding:
        yield (
            f"kept, and beside the arm file's masses: {', '.join(riding)}; take them out if the "
            "arm file's last link holds them already"
        )
    driven = [joint.name for joint in arm.joints]
    stiff = [
        name
        for name in driven
        if float(np.max(np.abs(model.jnt_stiffness[model.joint(name).id]))) > 0.0
    ]
    if stiff:
        yield f"springs that the file has on {', '.join(stiff)} are kept on the driven joints"
