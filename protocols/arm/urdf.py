"""A small reader of URDF: serial chains of revolute joints with inertials, nothing else.

Meshes, colours and transmissions are passed over. Links on fixed joints are merged into the
link that carries them; the frame of the first link is the base.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import NoReturn
from xml.etree import ElementTree as ET
from xml.parsers import expat

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.inertial import merge_bodies, physical_link
from armodal.protocols.arm.records import InertialLink
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ArmError

__all__ = ["Chain", "UrdfJoint", "parse_xml", "parsed_with_comments", "read_urdf", "rotation_rpy"]

_MOST_LINKS = 64
_DEEPEST = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfJoint:
    """A revolute joint of the chain and the link it moves."""

    name: str
    T_parent_joint: npt.NDArray[np.float64]  # (4, 4)
    axis: npt.NDArray[np.float64]  # (3,) unit
    range_rad: tuple[float, float]
    link_name: str
    link: InertialLink | None  # None where its inertials are given elsewhere


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """A serial chain, from the base outwards."""

    name: str
    base: str  # name of the first link
    joints: tuple[UrdfJoint, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Body:
    """Everything that fixed joints hold together, in the frame of its first link."""

    names: tuple[str, ...]
    inertials: tuple[tuple[ET.Element, npt.NDArray[np.float64]], ...]
    moving: tuple[tuple[ET.Element, npt.NDArray[np.float64]], ...]


def read_urdf(text: str, *, replaced: Collection[str] = ()) -> Chain:
    """Read the chain of a URDF text.

    Parameters
    ----------
    replaced
        Moving links whose inertials are given elsewhere: theirs are not looked at.

    Raises
    ------
    ArmError
        With the joint's or link's name, if the text is not XML, declares a document type, is not
        one serial chain of revolute and fixed joints, or holds an inertia no body can have.
    """
    root = parse_xml(text)
    if root.tag != "robot":
        raise ArmError(f"wanted the root element robot, got {root.tag[:40]!r}")
    links = _named(root, "link")
    joints = _named(root, "joint")
    if not 2 <= len(links) <= _MOST_LINKS:
        raise ArmError(f"wanted 2 to {_MOST_LINKS} links, got {len(links)}")
    children: dict[str, list[ET.Element]] = {name: [] for name in links}
    parents: dict[str, str] = {}
    for name, joint in joints.items():
        parent, child = _end(joint, "parent", links), _end(joint, "child", links)
        if child in parents:
            raise ArmError(f"joint {name}: wanted a link with one parent, got {child} again")
        parents[child] = parent
        children[parent].append(joint)
    roots = [name for name in links if name not in parents]
    if len(roots) != 1:
        raise ArmError(f"wanted one link without a parent, got {len(roots)}: {roots[:4]}")

    chain: list[UrdfJoint] = []
    seen = 0
    body = _body(roots[0], links, children)
    while True:
        seen += len(body.names)
        if len(body.moving) > 1:
            names = ", ".join(j.get("name", "") for j, _ in body.moving)
            raise ArmError(f"wanted a serial chain, got a branch at {body.names[0]}: {names}")
        if not body.moving:
            break
        element, T_body_origin = body.moving[0]
        body = _body(_end(element, "child", links), links, children)
        chain.append(_joint(element, T_body_origin, body, replaced))
    if seen != len(links):
        raise ArmError(f"wanted every link on the chain, got {len(links) - seen} in a loop")
    if not chain:
        raise ArmError("wanted at least one revolute joint, got none")
    return Chain(name=root.get("name", ""), base=roots[0], joints=tuple(chain))


def rotation_rpy(roll: float, pitch: float, yaw: float) -> npt.NDArray[np.float64]:
    """Rotation of fixed-axis roll, pitch, yaw angles, rad: Rz(yaw) Ry(pitch) Rx(roll), (3, 3)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def parse_xml(text: str) -> ET.Element:
    """Read a text as XML without a document type, or raise ArmError."""
    depth = 0

    def start(_name: str, _attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _DEEPEST:
            raise ArmError(f"wanted elements at most {_DEEPEST} deep, got more")

    def end(_name: str) -> None:
        nonlocal depth
        depth -= 1

    def doctype(*_arguments: object) -> NoReturn:
        raise ArmError("wanted plain XML, got a document type; remove the DOCTYPE")

    scanner = expat.ParserCreate()
    scanner.StartElementHandler = start
    scanner.EndElementHandler = end
    scanner.StartDoctypeDeclHandler = doctype
    try:
        # The scan refuses document types, so the second pass meets no entity to expand.
        scanner.Parse(text, True)
        return ET.fromstring(text)  # noqa: S314
    except (expat.ExpatError, ET.ParseError, ValueError) as problem:
        if isinstance(problem, ArmError):
            raise
        raise ArmError(f"wanted XML, got: {problem}") from problem


def parsed_with_comments(text: str) -> tuple[str, ET.Element]:
    """Read a text as `parse_xml` does: what stands before its root, and that with its comments."""
    parse_xml(text)
    builder = ET.TreeBuilder(insert_comments=True)
    root = ET.fromstring(text, parser=ET.XMLParser(target=builder))  # noqa: S314  # looked at
    starts: list[int] = []
    scanner = expat.ParserCreate()

    def start(_name: str, _attributes: dict[str, str]) -> None:
        starts.append(scanner.CurrentByteIndex)

    scanner.StartElementHandler = start
    scanner.Parse(text.encode(), True)
    return text.encode()[: starts[0]].decode(), root


def _named(root: ET.Element, tag: str) -> dict[str, ET.Element]:
    found: dict[str, ET.Element] = {}
    for element in root.findall(tag):
        name = element.get("name", "")
        if not name or name in found:
            raise ArmError(f"wanted every {tag} with a name of its own, got {name!r}")
        found[name] = element
    return found


def _end(joint: ET.Element, tag: str, links: dict[str, ET.Element]) -> str:
    element = joint.find(tag)
    name = "" if element is None else element.get("link", "")
    if name not in links:
        raise ArmError(f"joint {joint.get('name')}: wanted a {tag} link, got {name!r}")
    return name


def _body(
    first: str,
    links: dict[str, ET.Element],
    children: dict[str, list[ET.Element]],
) -> _Body:
    names, inertials, moving = [], [], []
    waiting: list[tuple[str, npt.NDArray[np.float64]]] = [(first, np.eye(4))]
    while waiting:
        name, T_body_link = waiting.pop()
        names.append(name)
        inertials.append((links[name], T_body_link))
        for joint in children[name]:
            T_body_joint = T_body_link @ _origin(joint, f"joint {joint.get('name')}")
            kind = joint.get("type")
            if joint.find("mimic") is not None:
                raise ArmError(
                    f"joint {joint.get('name')}: wanted a joint that moves by itself, got one that "
                    "mimics another; make it fixed, or write the arm without what it drives"
                )
            if kind == "fixed":
                waiting.append((_end(joint, "child", links), T_body_joint))
            elif kind in {"revolute", "continuous"}:
                moving.append((joint, T_body_joint))
            else:
                raise ArmError(
                    f"joint {joint.get('name')}: wanted type revolute, continuous or fixed, got "
                    f"{kind!r}; make it fixed where it is held, or leave out what it carries"
                )
    return _Body(names=tuple(names), inertials=tuple(inertials), moving=tuple(moving))


def _joint(
    element: ET.Element,
    T_parent_joint: npt.NDArray[np.float64],
    body: _Body,
    replaced: Collection[str],
) -> UrdfJoint:
    name = element.get("name", "")
    axis_element = element.find("axis")
    text = "1 0 0" if axis_element is None else axis_element.get("xyz", "1 0 0")
    axis = np.array(_numbers(text, 3, f"joint {name}: axis xyz"))
    length = float(np.linalg.norm(axis))
    if length < 1e-6:
        raise ArmError(f"joint {name}: wanted an axis with a direction, got {text!r}")
    return UrdfJoint(
        name=name,
        T_parent_joint=frozen_array(T_parent_joint, np.float64),
        axis=frozen_array(axis / length, np.float64),
        range_rad=_range(element, name),
        link_name=body.names[0],
        link=None if body.names[0] in replaced else _link(body),
    )


def _range(element: ET.Element, name: str) -> tuple[float, float]:
    if element.get("type") == "continuous":
        return -math.inf, math.inf
    limit = element.find("limit")
    if limit is None:
        raise ArmError(f"joint {name}: wanted a limit, got none; add <limit lower upper>")
    lower = _number(limit.get("lower", "0"), f"joint {name}: limit lower")
    upper = _number(limit.get("upper", "0"), f"joint {name}: limit upper")
    if not lower < upper:
        raise ArmError(f"joint {name}: wanted limit lower < upper, got {lower} and {upper}")
    return lower, upper


def _link(body: _Body) -> InertialLink:
    name = body.names[0]
    parts = []
    for element, T_body_link in body.inertials:
        inertial = element.find("inertial")
        if inertial is None:
            continue
        part = f"link {element.get('name')}"
        T = T_body_link @ _origin(inertial, part)
        mass = _number(_attribute(inertial, "mass", "value", part), f"{part}: mass")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        xx, yy, zz, xy, xz, yz = (
            _number(_attribute(inertial, "inertia", key, part), f"{part}: {key}") for key in keys
        )
        if mass == 0.0 and element.get("name") != name and not any((xx, yy, zz, xy, xz, yz)):
            continue  # a frame fixed to the link, written as a body of nothing
        R = T[:3, :3]
        inertia = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
        link = physical_link(element.get("name", ""), mass, T[:3, 3], inertia)
        parts.append((link.mass_kg, link.center_m, link.inertia_kg_m2))
    if not parts:
        raise ArmError(
            f"link {name}: wanted an inertial, got none; a moving link has mass: "
            "add one to the URDF, or a link table to the arm file"
        )
    return merge_bodies(name, parts)


def _origin(element: ET.Element, owner: str) -> npt.NDArray[np.float64]:
    T = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        roll, pitch, yaw = _numbers(origin.get("rpy", "0 0 0"), 3, f"{owner}: origin rpy")
        T[:3, :3] = rotation_rpy(roll, pitch, yaw)
        T[:3, 3] = _numbers(origin.get("xyz", "0 0 0"), 3, f"{owner}: origin xyz")
    return T


def _attribute(parent: ET.Element, tag: str, key: str, owner: str) -> str:
    element = parent.find(tag)
    value = None if element is None else element.get(key)
    if value is None:
        raise ArmError(f"{owner}: wanted <{tag} {key}=...>, got none")
    return value


def _numbers(text: str, count: int, owner: str) -> list[float]:
    words = text.split()
    if len(words) != count:
        raise ArmError(f"{owner}: wanted {count} numbers, got {text[:60]!r}")
    return [_number(word, owner) for word in words]


def _number(text: str, owner: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or abs(value) > 1e6:
        raise ArmError(f"{owner}: wanted a finite number, got {text[:60]!r}")
    return value
