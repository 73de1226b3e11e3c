"""`armodal mozzi`: how the tool gives under a load, and about which axis."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import typer
from rich.table import Table

from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.screws import MozziAxis, Translation
from armodal.analyzer.statics.deflection import Deflections, JointLine, deflect, joint_lines
from armodal.analyzer.statics.ranking import rank_postures
from armodal.analyzer.workspace.meridian import meridian_plane
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.tui.command_parts.options import ArmName, Seed, comma_numbers
from armodal.tui.console import Json, out, print_json, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)

Array = npt.NDArray[np.float64]


def load_tool(
    arm: Arm, posture_deg: list[float], wrench: list[float], tool_m: list[float]
) -> tuple[Deflections, tuple[JointLine, ...]]:
    """Deflection of the tool in one posture, and how its Mozzi axis lies to the joints.

    Raises
    ------
    ArmError
        If the posture has another number of angles, or one outside its joint's range, or the
        wrench or the tool point is not what it should be.
    """
    joints_rad = wanted_posture(arm, posture_deg)
    if len(tool_m) != 3 or not np.isfinite(tool_m).all():
        raise ArmError(f"wanted a tool point of three finite metres, got {tool_m}")
    ready = batched(arm)
    found = deflect(ready.batch, ready.elastic, joints_rad[None], wrench, tool_m=tool_m)
    axis = found.mozzi()
    lines = joint_lines(ready.batch, joints_rad, axis) if isinstance(axis, MozziAxis) else ()
    return found, lines


class Elbow(StrEnum):
    """Which of the two ways the arm brings its wrist to a place."""

    UP = "up"
    DOWN = "down"


def posture_of_wrist(arm: Arm, place_m: list[float], elbow: Elbow) -> list[float]:
    """Joint angles in degrees that bring the wrist to a place of the meridian plane.

    Raises
    ------
    ArmError
        If the arm has no meridian plane, or the wrist does not reach the place.
    """
    angles = meridian_plane(arm).joints_at(place_m[0], place_m[1], elbow.value)
    return [float(angle) for angle in np.rad2deg(angles)]


def deflection_json(found: Deflections, lines: tuple[JointLine, ...]) -> dict[str, Any]:
    """The deflection as plain values."""
    axis = found.mozzi()
    return {
        "tool_m": found.tool_m[0].tolist(),
        "displacement_m": found.displacement_m[0].tolist(),
        "rotation_rad": found.rotation_rad[0].tolist(),
        "joints": [
            {
                "joint": name,
                "rotation_rad": float(found.joint_rotation_rad[0, i]),
                "share_of_displacement": _number(found.joint_share[0, i]),
            }
            for i, name in enumerate(found.names)
        ],
        "axis": {
            "direction": axis.direction.tolist(),
            "point_m": axis.point_m.tolist(),
            "pitch_m_per_rad": axis.pitch_m_per_rad,
            "rotation_rad": axis.rotation,
        }
        if isinstance(axis, MozziAxis)
        else None,
        "kind": "turns about an axis"
        if isinstance(axis, MozziAxis)
        else ("pure translation" if isinstance(axis, Translation) else "no motion"),
        "to_joint_axes": [
            {"joint": line.joint, "angle_deg": line.angle_deg, "distance_m": line.distance_m}
            for line in lines
        ],
    }


def deflection_tables(arm: Arm, found: Deflections, lines: tuple[JointLine, ...]) -> list[Table]:
    """The deflection as tables for people."""
    value = deflection_json(found, lines)
    motion = Table(title=f"Tool of {arm.name}: {value['kind']}", show_header=False)
    size_mm = 1e3 * float(np.linalg.norm(found.displacement_m[0]))
    motion.add_row("tool at, m", _vector(found.tool_m[0], "{:.3f}"))
    motion.add_row("displacement, mm", f"{_vector(1e3 * found.displacement_m[0])}  ({size_mm:.4f})")
    axis = found.mozzi()
    if isinstance(axis, MozziAxis):
        motion.add_row("axis direction", _vector(axis.direction, "{:.3f}"))
        motion.add_row("axis passes, m", _vector(axis.point_m, "{:.3f}"))
        motion.add_row("slide, mm/rad", f"{1e3 * axis.pitch_m_per_rad:.3f}")
        motion.add_row("rotation, mrad", f"{1e3 * axis.rotation:.4f}")
    shares = Table(title="By joint")
    for column in ("joint", "turns mrad", "of the displacement %", "axis angle deg", "away mm"):
        shares.add_column(column, justify="right")
    by_name = {line.joint: line for line in lines}
    elastic = {row["joint"]: row for row in value["joints"]}
    others = [name for name in found.names if name not in {joint.name for joint in arm.joints}]
    for name in (*(joint.name for joint in arm.joints), *others):
        row, line = elastic.get(name), by_name.get(name)
        share = None if row is None else row["share_of_displacement"]
        shares.add_row(
            name,
            "rigid" if row is None else f"{1e3 * row['rotation_rad']:.4f}",
            "" if share is None else f"{100 * share:.1f}",
            "" if line is None else f"{line.angle_deg:.1f}",
            "" if line is None else f"{1e3 * line.distance_m:.1f}",
        )
    return [motion, shares]


def rank_random_postures(
    arm: Arm, wrench: list[float], tool_m: list[float], *, n: int, best: int, seed: int
) -> list[dict[str, Any]]:
    """The stiffest of random postures for a force on the tool; the surface is across the force.

    Raises
    ------
    ArmError
        If the wrench holds no force.
    """
    force = np.asarray(wrench[:3], dtype=np.float64)
    if not np.linalg.norm(force) > 0:
        raise ArmError("wanted a wrench with a force to rank postures for, got none")
    postures = random_postures(arm, n, np.random.default_rng(seed))
    ready = batched(arm)
    ranked = rank_postures(ready.batch, ready.elastic, postures, wrench, -force, tool_m=tool_m)
    return [
        {
            "posture_deg": np.rad2deg(ranked.joints_rad[i]).tolist(),
            "tool_m": ranked.tool_m[i].tolist(),
            "displacement_m": float(ranked.displacement_m[i]),
            "into_surface_m": float(ranked.into_surface_m[i]),
            "axis_distance_m": _number(ranked.axis_distance_m[i]),
        }
        for i in range(min(best, n))
    ]


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _vector(values: Array, form: str = "{:+.4f}") -> str:
    return "  ".join(form.format(value) for value in values)


@app.command("mozzi")
def mozzi_command(
    arm: ArmName,
    wrench: Annotated[str, typer.Option(help="fx,fy,fz,mx,my,mz at the tool, base axes, N, N m.")],
    posture: Annotated[
        str | None, typer.Option(help="Joint angles in degrees, separated by commas.")
    ] = None,
    wrist: Annotated[
        str | None,
        typer.Option(
            help="Instead of --posture: the wrist at HORIZONTAL,VERTICAL in the meridian plane, m."
        ),
    ] = None,
    elbow: Annotated[Elbow, typer.Option(help="Elbow up or down, with --wrist.")] = Elbow.UP,
    at: Annotated[
        str, typer.Option(help="Tool point x,y,z in the last link's frame, m.")
    ] = "0,0,0",
    rank: Annotated[
        int,
        typer.Option(
            min=0, max=10_000_000, help="Instead of one posture: rank this many random ones."
        ),
    ] = 0,
    best: Annotated[int, typer.Option(min=1, help="How many of them are shown.")] = 10,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """How the tool moves under a load: displacement, Mozzi axis, share of each joint.

    Example: armodal mozzi viper_s650 --posture 0,0,60,0,40,0 --wrench 0,50,-100,0,0,0 --at 0,0,0.1
    """
    the_arm = load_arm(arm)
    load, tool = comma_numbers(wrench, "--wrench", 6), comma_numbers(at, "--at", 3)
    if rank:
        rows = rank_random_postures(the_arm, load, tool, n=rank, best=best, seed=seed)
        if as_json:
            print_json({"arm": the_arm.name, "postures": rows})
            return
        for row in rows:
            angles = " ".join(f"{angle:7.1f}" for angle in row["posture_deg"])
            out.print(f"{1e3 * row['displacement_m']:9.4f} mm  at {angles} deg")
        say_next(f"workspace {arm}", "frequencies over all postures")
        return
    if (posture is None) == (wrist is None):
        raise ArmError(
            "wanted one of --posture with the joint angles in degrees, --wrist with its place in "
            f"the meridian plane, and --rank; got {'none' if posture is None else 'two'}"
        )
    if wrist is not None:
        asked = posture_of_wrist(the_arm, comma_numbers(wrist, "--wrist", 2), elbow)
    else:
        asked = comma_numbers(posture or "", "--posture")
    found, lines = load_tool(the_arm, asked, load, tool)
    if as_json:
        print_json({"arm": the_arm.name, "posture_deg": asked} | deflection_json(found, lines))
        return
    for table in deflection_tables(the_arm, found, lines):
        out.print(table)
    say_next(f"workspace {arm}", "frequencies over all postures")
