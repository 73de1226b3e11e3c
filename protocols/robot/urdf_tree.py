"""A URDF as it is: every link and joint, and everything that is wrong with the text.

Unlike `protocols.arm.urdf`, which reads a chain or refuses at the first fault, this goes on past
faults, so that one run tells all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.urdf import parse_xml, rotation_rpy
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.packages import find_mesh
from armodal.protocols.robot.records import Inertial, Robot, RobotJoint, RobotLink, Shape
from armodal.protocols.robot.remarks import Remarks

__all__ = ["read_tree"]

Array = npt.NDArray[np.float64]

_LARGEST = 1e6
# Their attributes, and how many numbers each holds.
_SHAPES = {
    "box": ("size", 3),
    "cylinder": ("radius length", 1),
    "capsule": ("radius length", 1),
    "sphere": ("radius", 1),
}


def read_tree(
    text: str, near: Path, said: Remarks, *, folders: Sequence[Path] = ()
) -> Robot | None:
    """Read a URDF's links and joints.

    Parameters
    ----------
    near
        Folder of the file, from which meshes are looked for.
    said
        Takes a fault for everything that cannot be read.

    Returns
    -------
    Robot or None
        None where the text is not a URDF at all.
    """
    try:
        root = parse_xml(text)
    except ArmError as problem:
        said.fault("file", str(problem))
        return None
    if root.tag != "robot":
        said.fault("file", f"wanted the root element robot, got {root.tag[:40]!r}")
        return None
    reader = _Reader(near, folders, said)
    links = {}
    for name, element in reader.named(root, "link"):
        links[name] = RobotLink(
            name=name,
            inertial=reader.inertial(element, f"link {name}"),
            visual=reader.shapes(element, "visual", f"link {name}"),
            collision=reader.shapes(element, "collision", f"link {name}"),
        )
    if not links:
        said.fault(
            "links",
            "wanted links, found none; if the file holds macros alone, give the one that uses them",
        )
        return None
    joints = [
        joint
        for name, element in reader.named(root, "joint")
        if (joint := reader.joint(element, name, links)) is not None
    ]
    return Robot(name=root.get("name", ""), links=links, joints=tuple(joints))


class _Reader:
    """Reads elements; what it cannot read it says, and puts a harmless value there."""

    def __init__(self, near: Path, folders: Sequence[Path], said: Remarks) -> None:
        self._near, self._folders, self._said = near, folders, said

    def named(self, root: ET.Element, tag: str) -> list[tuple[str, ET.Element]]:
        found: dict[str, ET.Element] = {}
        for number, element in enumerate(root.findall(tag), start=1):
            name = element.get("name", "")
            if not name:
                self._said.fault(f"{tag} number {number}", "wanted a name, got none")
            elif name in found:
                self._said.fault(f"{tag} {name}", "wanted a name of its own, got it twice")
            else:
                if any(c.isspace() or not c.isprintable() for c in name):
                    self._said.fault(
                        f"{tag} {name!r}", "wanted a name without spaces; rename it everywhere"
                    )
                found[name] = element
        return list(found.items())

    def inertial(self, link: ET.Element, where: str) -> Inertial | None:
        element = link.find("inertial")
        if element is None:
            return None
        T = self.origin(element, f"{where}: inertial")
        mass = self.number(_get(element, "mass", "value"), f"{where}: mass value")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        six = [
            self.number(_get(element, "inertia", key), f"{where}: inertia {key}", missing="0")
            for key in keys
        ]
        xx, yy, zz, xy, xz, yz = six
        R = T[:3, :3]
        return Inertial(
            mass_kg=mass,
            center_m=T[:3, 3],
            inertia_kg_m2=R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T,
        )

    def shapes(self, link: ET.Element, tag: str, where: str) -> tuple[Shape, ...]:
        found = []
        for element in link.findall(tag):
            geometry = element.find("geometry")
            form = None if geometry is None else next(iter(geometry), None)
            if form is None:
                self._said.fault(f"{where}: {tag}", "wanted a geometry, got none")
                continue
            T = self.origin(element, f"{where}: {tag}")
            if form.tag == "mesh":
                found.append(self._mesh(form, T, f"{where}: {tag}"))
            elif form.tag in _SHAPES:
                keys, count = _SHAPES[form.tag]
                size = [
                    value
                    for key in keys.split()
                    for value in self.numbers(
                        form.get(key, ""), count, f"{where}: {tag} {form.tag} {key}"
                    )
                ]
                if min(size) <= 0.0:
                    self._said.fault(
                        f"{where}: {tag}", f"wanted a {form.tag} of a size above 0, got {size}"
                    )
                    continue
                found.append(Shape(kind=form.tag, size_m=tuple(size), T_link_shape=T))
            else:
                self._said.note(f"{where}: {tag}", f"a shape {form.tag!r} is passed over")
        return tuple(found)

    def _mesh(self, form: ET.Element, T: Array, where: str) -> Shape:
        named = form.get("filename", "")
        scale = self.numbers(form.get("scale", "1 1 1"), 3, f"{where}: mesh scale")
        if math.prod(scale) == 0.0:
            self._said.fault(where, f"wanted a mesh scale of no zeros, got {scale}")
            scale = [1.0, 1.0, 1.0]
        elif math.prod(scale) < 0.0:
            self._said.fault(
                where,
                f"wanted right-handed axes, got the mesh scale {scale[0]:g} {scale[1]:g} "
                f"{scale[2]:g}, which mirrors; save the mesh mirrored, with a scale above 0",
            )
        file = find_mesh(named, self._near, self._folders)
        return Shape(kind="mesh", size_m=tuple(scale), T_link_shape=T, named=named, file=file)

    def joint(
        self, element: ET.Element, name: str, links: dict[str, RobotLink]
    ) -> RobotJoint | None:
        where = f"joint {name}"
        ends = []
        for tag in ("parent", "child"):
            link = _get(element, tag, "link")
            if link not in links:
                self._said.fault(where, f"wanted a {tag} link of the file, got {link!r}")
            ends.append(link or "")
        if not all(end in links for end in ends):
            return None
        kind = element.get("type", "")
        axis = np.array([1.0, 0.0, 0.0])
        if kind not in {"fixed", "floating"} and element.find("axis") is not None:
            axis = np.array(
                self.numbers(_get(element, "axis", "xyz") or "1 0 0", 3, f"{where}: axis xyz")
            )
        length = float(np.linalg.norm(axis))
        if length < 1e-6:
            self._said.fault(where, "wanted an axis with a direction, got zeros")
            axis, length = np.array([1.0, 0.0, 0.0]), 1.0
        mimic = element.find("mimic")
        return RobotJoint(
            name=name,
            kind=kind,
            parent=ends[0],
            child=ends[1],
            T_parent_joint=self.origin(element, where),
            axis=axis / length,
            range_rad=self._range(element, kind, where),
            mimics=None if mimic is None else mimic.get("joint", ""),
        )

    def _range(self, element: ET.Element, kind: str, where: str) -> tuple[float, float] | None:
        limit = element.find("limit")
        if limit is None or kind not in {"revolute", "prismatic"}:
            return None
        lower = self.number(limit.get("lower", "0"), f"{where}: limit lower")
        upper = self.number(limit.get("upper", "0"), f"{where}: limit upper")
        return lower, upper

    def origin(self, element: ET.Element, where: str) -> Array:
        T = np.eye(4)
        origin = element.find("origin")
        if origin is not None:
            roll, pitch, yaw = self.numbers(origin.get("rpy", "0 0 0"), 3, f"{where}: origin rpy")
            T[:3, :3] = rotation_rpy(roll, pitch, yaw)
            T[:3, 3] = self.numbers(origin.get("xyz", "0 0 0"), 3, f"{where}: origin xyz")
        return T

    def numbers(self, text: str, count: int, where: str) -> list[float]:
        words = text.split()
        if len(words) != count:
            self._said.fault(where, f"wanted {count} numbers, got {text[:60]!r}")
            return [0.0] * count
        return [self.number(word, where) for word in words]

    def number(self, text: str | None, where: str, *, missing: str | None = None) -> float:
        try:
            value = float(text if text is not None else missing or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or abs(value) > _LARGEST:
            self._said.fault(where, f"wanted a number, got {(text or 'nothing')[:60]!r}")
            return 0.0
        return value


def _get(parent: ET.Element, tag: str, key: str) -> str | None:
    element = parent.find(tag)
    return None if element is None else element.get(key)
