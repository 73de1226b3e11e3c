"""The texts of a new arm: its arm file and the URDF beside it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.drives import SOURCE, STD, Drive
from armodal.analyzer.own_arm.guess import BelievedLinks
from armodal.analyzer.own_arm.points import FoundPoint
from armodal.protocols.arm.records import InertialLink, KeepOut
from armodal.protocols.robot.chain import CutChain
from armodal.protocols.robot.remarks import Remarks

__all__ = ["arm_text", "urdf_text"]

Array = npt.NDArray[np.float64]

_DAMPING_STD = 0.6
_LONGEST_SOURCE = 2000
_OTHERS = (
    ("encoder_offset_deg", 0.1),
    ("sensor_tilt_deg", 1.0),
    ("sensor_gain", 0.02),
    ("hammer_gain", 0.02),
    ("hit_direction_deg", 3.0),
)


def urdf_text(
    chain: CutChain, links: Sequence[InertialLink], shapes: Sequence[Sequence[str]]
) -> str:
    """A URDF of the arm alone: a body for each joint, with its inertial and its shapes.

    Parameters
    ----------
    shapes
        For the base and every moving body the files of its shapes, beside the URDF.
    """
    rows = ['<?xml version="1.0"?>', f"<robot name={_quoted(chain.name or 'arm')}>"]
    rows += [f"  <link name={_quoted(chain.base.name)}>", *_meshes(shapes[0]), "  </link>"]
    parent = chain.base.name
    for body, link, files in zip(chain.bodies, links, shapes[1:], strict=True):
        joint = body.joint
        if joint is None:
            continue
        low, high = body.range_rad
        rows += [
            f'  <joint name={_quoted(joint.name)} type="revolute">',
            f"    {_origin(body.T_parent_joint)}",
            f"    <parent link={_quoted(parent)}/>",
            f"    <child link={_quoted(body.name)}/>",
            f'    <axis xyz="{_numbers(joint.axis)}"/>',
            f'    <limit lower="{low:.9g}" upper="{high:.9g}" effort="0" velocity="0"/>',
            "  </joint>",
            f"  <link name={_quoted(body.name)}>",
            *_inertial(link),
            *_meshes(files),
            "  </link>",
        ]
        parent = body.name
    return "\n".join([*rows, "</robot>", ""])


def arm_text(
    name: str,
    urdf: str,
    chain: CutChain,
    believed: BelievedLinks,
    drives: Sequence[Drive | None],
    points: Sequence[FoundPoint],
    gravity_m_s2: Sequence[float],
    keep_outs: Sequence[KeepOut],
    said: Remarks,
) -> str:
    """The arm file; every guess stands in it, with its source."""
    told = [f"# - {remark}" for remark in said.of("guess", "doubt")]
    rows = [
        "# Made by `armodal arm new`. Format: docs/arm-file.md",
        *(["# Guessed or doubted, each to be checked (README.md):"] if told else []),
        *told,
        'format = "armodal-arm-1"',
        f"name = {_text(name)}",
        f"source = {_text(_source(chain, believed))}",
        f"urdf = {_text(urdf)}",
        f"gravity_m_s2 = {_list(gravity_m_s2)}",
    ]
    for body, drive, std in zip(chain.bodies, drives, believed.stds, strict=True):
        if body.joint is None:
            continue
        rows += ["", "[[joints]]", f"name = {_text(body.joint.name)}"]
        if drive is not None:
            rows += [
                f"stiffness_n_m_per_rad = {_estimate(drive.stiffness_n_m_per_rad, STD)}",
                f"damping_n_m_s_per_rad = {_estimate(drive.damping_n_m_s_per_rad, _DAMPING_STD)}",
            ]
        else:
            rows.append("# believed rigid: its own mode lies above the band")
        if believed.guessed:
            rows.append(
                f"inertial_std = {{ mass = {std.mass:.3g}, inertia = {std.inertia:.3g}, "
                f"center_m = {std.center_m:.3g}{', guessed = true' if std.guessed else ''} }}"
            )
    names = ["base", *(body.name for body in chain.bodies)]
    for point in points:
        rows += [
            "",
            "[[points]]",
            f"id = {_text(point.id)}",
            f"link = {_text(names[point.body])}",
            f"position_m = {_list(point.position_m, 5)}",
            f"normal = {_list(point.normal, 6)}",
            f"x_axis = {_list(point.x_axis, 6)}",
        ]
    for box in keep_outs:
        rows += [
            "",
            "# A box along the base's axes to stay out of; add pedestal, cables, fences likewise.",
            "[[keep_outs]]",
            f"name = {_text(box.name)}",
            f"low_m = {_list(box.low_m, 4)}",
            f"high_m = {_list(box.high_m, 4)}",
        ]
    rows += [
        "",
        "# One standard deviation. A stiffness is proportional to the inertias: none can be known",
        "# better than `mass` and `inertia` are; where a joint has `inertial_std`, that counts.",
        "[tolerances]",
        f"mass = {believed.mass:g}",
        f"inertia = {believed.inertia:g}",
        f"center_m = {believed.center_m:.3g}",
        *(f"{key} = {value:g}" for key, value in _OTHERS),
        *([f"moving_mass = {believed.moving_mass:.3g}"] if believed.moving_mass else []),
    ]
    return "\n".join([*rows, ""])


def _source(chain: CutChain, believed: BelievedLinks) -> str:
    parts = [f"Robot description '{chain.name or 'without a name'}', cut at {chain.tip}."]
    if believed.guessed:
        parts.append(f"Inertials guessed from hulls: {', '.join(believed.guessed)}.")
    else:
        parts.append("Inertials as the description gives them.")
    parts.append("Stiffness and damping: guesses. Points: found on the surfaces.")
    return " ".join(parts)[:_LONGEST_SOURCE]


def _text(value: str) -> str:
    """A TOML string: JSON's escapes are TOML's, but for pairs of surrogates."""
    return json.dumps(value, ensure_ascii=False)


def _estimate(value: float, std: float) -> str:
    source = _text(SOURCE)
    return f"{{ value = {_digits(value)}, std = {_digits(std * value)}, source = {source} }}"


def _digits(value: float) -> str:
    """Three digits, as a TOML float."""
    return repr(float(f"{value:.3g}"))


def _list(values: Sequence[float] | Array, digits: int = 6) -> str:
    return "[" + ", ".join(repr(round(float(value), digits) + 0.0) for value in values) + "]"


def _quoted(text: str) -> str:
    replaced = text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return f'"{replaced}"'


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(f"{float(value) + 0.0:.12g}" for value in values)


def _origin(T: Array) -> str:
    R = T[:3, :3]
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) > 1e-9:
        roll, yaw = math.atan2(R[2, 1], R[2, 2]), math.atan2(R[1, 0], R[0, 0])
    else:  # only their difference tells
        roll, yaw = math.atan2(-R[1, 2], R[1, 1]), 0.0
    return f'<origin xyz="{_numbers(T[:3, 3])}" rpy="{_numbers((roll, pitch, yaw))}"/>'


def _inertial(link: InertialLink) -> list[str]:
    inertia = link.inertia_kg_m2
    places = [(i, j) for i in range(3) for j in range(i, 3)]
    values = " ".join(f'i{"xyz"[i]}{"xyz"[j]}="{inertia[i, j] + 0.0:.12g}"' for i, j in places)
    return [
        "    <inertial>",
        f'      <origin xyz="{_numbers(link.center_m)}"/>',
        f'      <mass value="{link.mass_kg:.9g}"/>',
        f"      <inertia {values}/>",
        "    </inertial>",
    ]


def _meshes(files: Sequence[str]) -> list[str]:
    rows = []
    for number, file in enumerate(files):
        tag = "visual" if number == 0 else "collision"
        mesh = f"<mesh filename={_quoted(file)}/>"
        rows.append(f"    <{tag}><geometry>{mesh}</geometry></{tag}>")
    return rows
