"""`armodal arm show`: the arm with its test points, in the terminal or as a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from armodal.analyzer.own_arm.of_arm import bodies_of_arm
from armodal.analyzer.own_arm.picture import points_page
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.remarks import Remarks, refuse_faults
from armodal.protocols.text_file import write_new_text
from armodal.tui.command_parts.mesh_folder import mesh_folder
from armodal.tui.command_parts.options import ArmName, comma_numbers
from armodal.tui.console import Json, err, out, print_json
from armodal.tui.drawing import Camera, Canvas, arm_wireframe, draw_points, draw_triad

__all__ = ["show_command"]

_ROWS = 30
_TRIAD = 0.12  # of the arm's reach


def show_command(
    arm: ArmName,
    points: Annotated[
        list[str] | None, typer.Argument(help="Points whose axes x, y, z are drawn; else none.")
    ] = None,
    posture: Annotated[
        str | None, typer.Option(help="Joint angles in degrees; else the middle of the ranges.")
    ] = None,
    html: Annotated[Path | None, typer.Option(help="A page to write, never replaced.")] = None,
    as_json: Json = False,
) -> None:
    """Show where the test points are: a wireframe here, the meshes with --html.

    Example: armodal arm show ur5 7 --posture 0,-60,60,0,90,0
    """
    the_arm = load_arm(arm)
    middle = [np.rad2deg(np.mean(joint.range_rad)) for joint in the_arm.joints]
    angles = comma_numbers(posture, "--posture", len(middle)) if posture else middle
    q = np.deg2rad(np.array(angles, dtype=np.float64))
    wire = arm_wireframe(the_arm, q)
    for name in points or []:
        if name not in wire.point_ids:
            ids = ", ".join(wire.point_ids)
            raise ArmError(f"wanted points of the arm, {ids}, got {name!r}")
    if html is not None:
        said = Remarks()
        bodies = bodies_of_arm(the_arm, mesh_folder(arm), said)
        refuse_faults(arm, said)
        write_new_text(html, points_page(the_arm, bodies or (), q), error=ArmError)
    if as_json:
        rows = [
            {"id": point.id, "link": point.link, "place_m": place.tolist(), "axes": R.T.tolist()}
            for point, place, R in zip(
                the_arm.points, wire.point_m, wire.point_rotation, strict=True
            )
        ]
        print_json({"arm": the_arm.name, "posture_deg": list(angles), "points": rows})
        return
    canvas = Canvas(max(out.width - 1, 20), _ROWS)
    camera = Camera.around(wire.everything_m())
    wire.draw(canvas, camera)
    draw_points(canvas, camera, wire, "bold", names=True)
    for name in points or []:
        i = wire.point(name)
        draw_triad(canvas, camera, wire.point_m[i], wire.point_rotation[i], _TRIAD * wire.reach_m)
    out.print(canvas.text())
    err.print(f"next: {f'open {html}' if html else 'add --html points.html to see the meshes'}")
