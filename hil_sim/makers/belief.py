"""The arm as a laboratory believes it: its arm file and URDF, in text."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable, Inertial
from armodal.hil_sim.makers.shell_points import shell_points
from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm

__all__ = ["Believed", "believed_arm", "urdf_text"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Believed:
    """A value as the arm file has it."""

    value: float
    std: float
    source: str


def believed_arm(
    table: ArmTable,
    stiffness: Mapping[str, Believed],
    damping: Mapping[str, Believed],
    tolerances: Mapping[str, float],
) -> Arm:
    """Return the arm of a table with what is believed of its drives.

    Parameters
    ----------
    stiffness, damping
        By joint, in N m/rad and N m s/rad; a joint without is believed rigid.
    tolerances
        The keys of the arm file's table of that name.
    """
    lines = [
        'format = "armodal-arm-1"',
        f"name = {_text(table.name)}",
        f"source = {_text(table.source)}",
        f"urdf = {_text(table.name + '.urdf')}",
    ]
    for row in table.links:
        low, high = row.range_deg
        lines += ["", "[[joints]]", f"name = {_text(row.joint)}", f"range_deg = [{low}, {high}]"]
        if row.joint in stiffness:
            lines.append(f"stiffness_n_m_per_rad = {_estimate(stiffness[row.joint])}")
            lines.append(f"damping_n_m_s_per_rad = {_estimate(damping[row.joint])}")
    for point in shell_points(table):
        lines += [
            "",
            "[[points]]",
            f"id = {_text(point.id)}",
            f"link = {_text(point.link)}",
            f"position_m = {_numbers(point.position_m, 4)}",
            f"normal = {_numbers(point.R_link_sensor[:, 2], 6)}",
            f"x_axis = {_numbers(point.R_link_sensor[:, 0], 6)}",
        ]
    lines += ["", "[tolerances]", *(f"{key} = {value:.4g}" for key, value in tolerances.items())]
    text = "\n".join(lines) + "\n"
    return arm_from_texts(text, urdf_text=urdf_text(table), database_text=None)


def urdf_text(table: ArmTable, inertials: Sequence[Inertial] | None = None) -> str:
    """Return the URDF of a table, with other inertials of the moving links where they are given."""
    robot = ET.Element("robot", name=table.name)
    _link(robot, "base_link", table.base)
    parent = "base_link"
    for row, body in zip(table.links, inertials or table.inertials(), strict=True):
        _link(robot, row.link, body)
        joint = ET.SubElement(robot, "joint", name=row.joint, type="revolute")
        ET.SubElement(joint, "origin", xyz=_words(row.xyz_m), rpy=_words(row.rpy_rad))
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=row.link)
        ET.SubElement(joint, "axis", xyz="0 0 1")
        low, high = np.deg2rad(row.range_deg)
        limits = {"lower": f"{low:.9f}", "upper": f"{high:.9f}", "effort": "1e5", "velocity": "10"}
        ET.SubElement(joint, "limit", limits)
        parent = row.link
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _link(robot: ET.Element, name: str, body: Inertial) -> None:
    inertial = ET.SubElement(ET.SubElement(robot, "link", name=name), "inertial")
    ET.SubElement(inertial, "origin", xyz=_words(body.center_m), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=repr(body.mass_kg))
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    values = (repr(value) for value in body.inertia_kg_m2)
    ET.SubElement(inertial, "inertia", dict(zip(keys, values, strict=True)))


def _estimate(belief: Believed) -> str:
    value, std, source = belief.value, belief.std, _text(belief.source)
    return f"{{ value = {value:.4g}, std = {std:.3g}, source = {source} }}"


def _numbers(values: Sequence[float] | np.ndarray, digits: int) -> str:
    return "[" + ", ".join(f"{float(value):.{digits}f}" for value in values) + "]"


def _words(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _text(text: str) -> str:
    return json.dumps(text)
