"""`armodal stiffness-map`: how stiff the tool stands, along a path or over the reach."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from armodal.analyzer.acting.self_motion import FreeAngle, stiffest_angle
from armodal.analyzer.acting.stiffness import (
    PlaneStiffness,
    ToolStiffness,
    stiffness_in_plane,
    tool_stiffness,
)
from armodal.analyzer.acting.stiffness_page import (
    angle_figure,
    path_figure,
    plane_figure,
    stiffness_csv,
    stiffness_page,
)
from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.batch import BatchedArm, batched
from armodal.analyzer.corrected.posture_file import read_postures
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.options import ArmName, comma_numbers
from armodal.tui.console import Json, out, print_json
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_LINES = 81  # of the grid each way


@app.command("stiffness-map")
def stiffness_map_command(
    arm: ArmName,
    force: Annotated[str, typer.Option(help="fx,fy,fz at the tool, base axes, N.")],
    path: Annotated[
        Path | None,
        typer.Option("--path", help="Text file: joint angles in degrees, one posture a line."),
    ] = None,
    plane: Annotated[
        bool, typer.Option("--plane", help="Instead: the wrist's places in the meridian plane.")
    ] = False,
    at: Annotated[
        str, typer.Option(help="Tool point x,y,z in the last link's frame, m.")
    ] = "0,0,0",
    free_angle: Annotated[
        bool, typer.Option("--free-angle", help="Seven joints: the best angle for each tool pose.")
    ] = False,
    spin: Annotated[
        str | None,
        typer.Option(
            help="Six joints: the best turn about this tool axis x,y,z (last link's frame)."
        ),
    ] = None,
    csv: Annotated[Path | None, typer.Option(help="CSV file to write, one posture a line.")] = None,
    html: Annotated[Path | None, typer.Option(help="Page with the picture to write.")] = None,
    as_json: Json = False,
) -> None:
    """Cartesian stiffness for a force, with the stiffest posture; effects included.

    Example: armodal stiffness-map demo/demo.arm.toml --plane --force 0,0,-200 --html stiff.html
    """
    the_arm = load_arm(arm)
    if plane == (path is not None):
        raise ArmError(
            f"wanted one of --path and --plane, got {'both' if plane else 'neither'}; give one"
        )
    axis = None if spin is None else comma_numbers(spin, "--spin", 3)
    _check_free(plane=plane, free_angle=free_angle, axis=axis)
    load, tool = comma_numbers(force, "--force", 3), comma_numbers(at, "--at", 3)
    for output in (csv, html):
        if output is not None:
            check_output(output, *([path] if path is not None else []))
    ready = batched(the_arm)
    whole: PlaneStiffness | None = None
    free: FreeAngle | None = None
    if path is None:
        whole = stiffness_in_plane(ready, load, tool_m=tool, n_lines=_LINES)
        reached = whole.elbow >= 0
        found = tool_stiffness(ready, whole.joints_rad[reached], load, tool_m=tool)
        figure = plane_figure(the_arm, whole)
    else:
        asked = read_postures(path, len(the_arm.joints))
        q = np.array([wanted_posture(the_arm, angles) for angles in asked])
        if free_angle or axis is not None:
            free = stiffest_angle(ready, q, load, tool_m=tool, spin=axis)
            found, figure = free.together, angle_figure(the_arm, free)
        else:
            found = tool_stiffness(ready, q, load, tool_m=tool)
            figure = path_figure(the_arm, found)
    words = [*_words(found, ready), *([] if free is None else _free_words(free))]
    written = {}
    if csv is not None:
        replace_text(csv, stiffness_csv(the_arm, found))
        written["csv"] = str(csv)
    if html is not None:
        replace_text(html, stiffness_page(the_arm, [figure], words))
        written["html"] = str(html)
    if as_json:
        value = _json(the_arm.name, found, whole, ready) | {"files": written}
        print_json(value if free is None else value | _free_json(free))
        return
    for text in words:
        out.print(text)
    for name, place in written.items():
        out.print(f"{name} {place}")
    out.print("next: armodal mozzi with the stiffest posture shows which joint gives way most")


def _words(found: ToolStiffness, ready: BatchedArm) -> list[str]:
    best, worst = found.best, int(np.argmin(found.along_n_per_m))
    least, most = (1e-6 * found.along_n_per_m[i] for i in (worst, best))
    place = " ".join(f"{value:.3f}" for value in found.tool_m[best])
    return [
        f"{len(found.along_n_per_m)} postures, along the force {least:.3f} to {most:.3f} N/µm",
        f"stiffest at {_angles(found.joints_rad[best])} deg, the tool at {place} m",
        f"softest at {_angles(found.joints_rad[worst])} deg",
        *ready.notes,
    ]


def _check_free(*, plane: bool, free_angle: bool, axis: list[float] | None) -> None:
    """Refuse options of the free angle that do not go together.

    Raises
    ------
    ArmError
        If there are two, none of a path, or the axis has no direction.
    """
    if free_angle and axis is not None:
        raise ArmError("wanted one of --free-angle and --spin, got both; give one")
    if plane and (free_angle or axis is not None):
        raise ArmError("wanted --free-angle and --spin with --path, got --plane; give a path")
    if axis is not None and not np.any(axis):
        raise ArmError("--spin: wanted the direction of an axis, got 0,0,0; such as 1,0,0")


def _free_words(free: FreeAngle) -> list[str]:
    words = []
    several = len(free.given.along_n_per_m) > 1
    ways = (("the whole path together", free.together), ("each pose by itself", free.best))
    for name, own in ways if several else ways[1:]:
        gain = own.along_n_per_m / free.given.along_n_per_m
        mean = float(np.mean(1.0 / own.along_n_per_m) / np.mean(1.0 / free.given.along_n_per_m))
        text = (
            f"{name}: {gain.min():.2f} to {gain.max():.2f} times as stiff as in the given postures"
        )
        if several:
            turned = np.rad2deg(np.abs(np.diff(own.joints_rad, axis=0)).max())
            text += (
                f", {100 * (1.0 - mean):.0f} % less deflection on the mean; from pose to pose a "
                f"joint turns by up to {turned:.1f} deg"
            )
        words.append(text)
    return words


def _free_json(free: FreeAngle) -> dict[str, Any]:
    return {
        "given_postures_deg": np.rad2deg(free.given.joints_rad).tolist(),
        "given_stiffness_along_n_per_m": free.given.along_n_per_m.tolist(),
        "free_angle_deg": np.rad2deg(free.together_angle_rad).tolist(),
        "each_alone": {
            "postures_deg": np.rad2deg(free.best.joints_rad).tolist(),
            "stiffness_along_n_per_m": free.best.along_n_per_m.tolist(),
            "free_angle_deg": np.rad2deg(free.best_angle_rad).tolist(),
        },
    }


def _angles(joints_rad: Any) -> str:
    return " ".join(f"{angle:.1f}" for angle in np.rad2deg(joints_rad))


def _json(
    name: str, found: ToolStiffness, whole: PlaneStiffness | None, ready: BatchedArm
) -> dict[str, Any]:
    best = found.best
    value: dict[str, Any] = {
        "arm": name,
        "freedoms": list(ready.elastic.names(ready.batch.arm)),
        "postures_deg": np.rad2deg(found.joints_rad).tolist(),
        "tool_m": found.tool_m.tolist(),
        "displacement_m": found.displacement_m.tolist(),
        "stiffness_along_n_per_m": found.along_n_per_m.tolist(),
        "stiffness_softest_n_per_m": found.softest_n_per_m.tolist(),
        "compliance_m_per_n": found.compliance_m_per_n.tolist(),
        "mozzi_axis_distance_m": [d if np.isfinite(d) else None for d in found.axis_distance_m],
        "best_posture_deg": np.rad2deg(found.joints_rad[best]).tolist(),
        "notes": list(ready.notes),
    }
    if whole is not None:
        value["elbow"] = [("up", "down")[i] for i in whole.elbow[whole.elbow >= 0]]
    return value
