"""The texts an imported session rests on: its arm file and its plan.

A session keeps its arm and plan as text, so an imported one gets both: the arm file it names with
the points added that only the foreign files know, or one of a structure without joints, and a
plan that says what the manifest said.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.urdf import Chain
from armodal.protocols.foreign.manifest import ManifestFile, PostureTable

__all__ = ["UNKNOWN_PLACES", "NewPoint", "PlanFacts", "bare_arm_text", "plan_text", "points_text"]

UNKNOWN_PLACES = "position not told"  # group of the points that no geometry places
URDF_NAME = "imported.urdf"
_SOURCE = "imported with foreign files; stiffness and damping unknown"

# Roughly known at best: a file of another program says nothing about mounting or calibration.
_TOLERANCES = """
[tolerances]
mass = 0.05
inertia = 0.06
center_m = 0.003
encoder_offset_deg = 0.15
sensor_tilt_deg = 1.0
sensor_gain = 0.02
hammer_gain = 0.02
hit_direction_deg = 1.5
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewPoint:
    """A test point that a foreign file brings."""

    id: str
    link: str
    position_m: npt.NDArray[np.float64]  # (3,) link frame
    R_link_sensor: npt.NDArray[np.float64]  # (3, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanFacts:
    """What a plan says beside the manifest."""

    arm: str
    fixed_point: str
    hits_per_point: int
    rate_hz: Fraction
    samples: int
    pretrigger: int
    level_n: float
    points: Sequence[Sequence[str]]  # of each posture


def bare_arm_text(
    name: str, chain: Chain | None, points: Sequence[NewPoint], unplaced: Sequence[str]
) -> str:
    """Return an arm file: of a URDF's chain believed rigid, or of a structure without joints."""
    head = [
        'format = "armodal-arm-1"',
        f"name = {_quoted(name)}",
        f"source = {_quoted(_SOURCE)}",
    ]
    if chain is None:
        head.append("joints = []")
        joints = ""
    else:
        head.append(f"urdf = {_quoted(URDF_NAME)}")
        joints = "".join(
            f"\n[[joints]]\nname = {_quoted(joint.name)}\n"
            + ("" if np.isfinite(joint.range_rad).all() else "range_deg = [-3600.0, 3600.0]\n")
            for joint in chain.joints
        )
    groups = ""
    if unplaced:
        groups = f"\n[groups]\n{_quoted(UNKNOWN_PLACES)} = {_list(unplaced)}\n"
    return "\n".join(head) + "\n" + joints + points_text(points) + groups + _TOLERANCES


def points_text(points: Sequence[NewPoint]) -> str:
    """Return the tables of points, fit to stand at the end of any arm file."""
    return "".join(
        f"\n[[points]]\nid = {_quoted(point.id)}\nlink = {_quoted(point.link)}\n"
        f"position_m = {_numbers(point.position_m)}\n"
        f"normal = {_numbers(point.R_link_sensor[:, 2])}\n"
        f"x_axis = {_numbers(point.R_link_sensor[:, 0])}\n"
        for point in points
    )


def plan_text(file: ManifestFile, facts: PlanFacts) -> str:
    """Return the plan an imported session would have followed."""
    lines = [
        "# Made by `armodal import` from its manifest.",
        'format = "armodal-plan-1"',
        'name = "imported"',
        f"arm = {_quoted(facts.arm)}",
        f"mode = {_quoted(file.mode)}",
        f"fixed_point = {_quoted(facts.fixed_point)}",
        f"hits_per_point = {facts.hits_per_point}",
        f"max_attempts = {facts.hits_per_point}",
        "",
        "[sampling]",
        f"rate_hz = {_quoted(_rate(facts.rate_hz))}",
        f"samples = {facts.samples}",
        f"pretrigger = {facts.pretrigger}",
        "",
        "[trigger]",
        f"level_n = {facts.level_n!r}",
        'slope = "rising"',
        "",
        "[windows]",
        f"exponential_end = {file.windows.exponential_end!r}",
    ]
    if file.windows.force_s is not None:
        lines.append(f"force_s = {file.windows.force_s!r}")
    lines += ["", "[averaging]", f"estimator = {_quoted(file.averaging.estimator)}"]
    if file.averaging.keep_hits is not None:
        lines.append(f"keep_hits = {file.averaging.keep_hits}")
    lines += ["", "[sensor]", f"mass_kg = {file.sensor_mass_kg or 0.0!r}"]
    for posture, points in zip(file.postures, facts.points, strict=True):
        lines += ["", *_posture(posture, points)]
    return "\n".join(lines) + "\n"


def _posture(posture: PostureTable, points: Sequence[str]) -> list[str]:
    lines = [
        "[[postures]]",
        f"name = {_quoted(posture.name)}",
        f"joints_deg = {_numbers(posture.joints_deg)}",
        "tolerance_deg = 0.5",
        f"points = {_list(points)}",
    ]
    if posture.hit_direction is not None:
        lines.append(f"hit_direction = {_numbers(posture.hit_direction)}")
    if posture.validation:
        lines.append("validation = true")
    return lines


def _rate(rate_hz: Fraction) -> str:
    return str(rate_hz) if rate_hz.denominator <= 10**6 else f"{float(rate_hz):.6f}"


def _quoted(text: str) -> str:
    """Return a TOML basic string; names here hold no control characters."""
    return json.dumps(text, ensure_ascii=False)


def _list(texts: Sequence[str]) -> str:
    return "[" + ", ".join(_quoted(text) for text in texts) + "]"


def _numbers(values: Sequence[float] | npt.NDArray[np.float64]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"
