"""`armodal arm move`: a test point put elsewhere on its link."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.moving import measured_on_surface, on_surface
from armodal.analyzer.own_arm.of_arm import bodies_of_arm
from armodal.analyzer.own_arm.towards import step_towards
from armodal.protocols.arm.files import load_arm, shipped_arms
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.arm.rewrite import text_with_point
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.remarks import Remarks, refuse_faults
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.options import comma_numbers
from armodal.tui.console import Json, err, out, print_json

__all__ = ["move_command"]

Array = npt.NDArray[np.float64]


def move_command(
    arm: Annotated[Path, typer.Argument(help="Arm file; it is changed.")],
    point: Annotated[str, typer.Argument(help="Id of the point.")],
    by: Annotated[str | None, typer.Option(help="Offset dx,dy,dz in the link's frame, m.")] = None,
    towards: Annotated[
        str | None,
        typer.Option(
            help="POINT:METRES or JOINT:METRES: so far towards a point or a joint's axis."
        ),
    ] = None,
    distances: Annotated[
        str | None,
        typer.Option(help="A:0.12,B:0.3,C:0.2: distances measured to three points of the link, m."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Move a test point on its link's surface; normal and sensor axes follow.

    Example: armodal arm move my-arm/my-arm.toml 7 --by 0.02,0,0
    """
    if str(arm) in shipped_arms():
        raise ArmError(f"wanted an arm file of your own, got the shipped arm {str(arm)!r}")
    if (by is not None) + (towards is not None) + (distances is not None) != 1:
        raise ArmError("wanted one of --by, --towards and --distances")
    the_arm = load_arm(arm)
    old = _point(the_arm, point)
    said = Remarks()
    bodies = bodies_of_arm(the_arm, arm.parent, said)
    refuse_faults(arm.name, said)
    body = next(body for body in bodies or () if body.name == old.link)
    if distances is not None:
        place, axes = _measured(the_arm, old, body, distances)
    else:
        step = (
            comma_numbers(by, "--by", 3) if by is not None else _step(the_arm, old, towards or "")
        )
        place, axes = on_surface(body, old.position_m + np.array(step), f"point {point}")
    moved = Point(id=old.id, link=old.link, position_m=place, R_link_sensor=axes)
    replace_text(arm, text_with_point(the_arm, moved))
    shift = float(np.linalg.norm(place - old.position_m))
    told = {"point": point, "link": old.link, "position_m": place.tolist(), "moved_m": shift}
    if as_json:
        print_json(told | {"normal": axes[:, 2].tolist(), "x_axis": axes[:, 0].tolist()})
        return
    at = ", ".join(f"{value:.4f}" for value in place)
    out.print(f"point {point} on link {old.link}: {at} m, {1e3 * shift:.0f} mm from where it was")
    err.print(f"next: `armodal plan {arm} --out PLAN` makes a plan with it")


def _point(arm: Arm, point_id: str) -> Point:
    try:
        return arm.point(point_id)
    except KeyError:
        ids = ", ".join(point.id for point in arm.points)
        raise ArmError(f"wanted one of the points {ids}, got {point_id!r}") from None


def _pairs(text: str, option: str, count: int) -> list[tuple[str, float]]:
    found = []
    for part in text.split(","):
        name, mark, number = part.rpartition(":")
        if not mark or not name:
            raise ArmError(f"{option}: wanted POINT:METRES, got {part!r}")
        found.append((name.strip(), comma_numbers(number, option, 1)[0]))
    if len(found) != count:
        raise ArmError(f"{option}: wanted {count} of POINT:METRES, got {len(found)}")
    return found


def _step(arm: Arm, old: Point, text: str) -> Array:
    ((name, metres),) = _pairs(text, "--towards", 1)
    try:
        return step_towards(arm, old, name, metres)
    except ArmError as problem:
        raise ArmError(f"--towards: {problem}") from None


def _measured(arm: Arm, old: Point, body: ArmBody, text: str) -> tuple[Array, Array]:
    pairs = _pairs(text, "--distances", 3)
    others = [_of_link(arm, old, name, "--distances").position_m for name, _ in pairs]
    return measured_on_surface(body, others, [metres for _, metres in pairs], f"point {old.id}")


def _of_link(arm: Arm, old: Point, name: str, option: str) -> Point:
    other = _point(arm, name)
    if other.link != old.link or other.id == old.id:
        raise ArmError(f"{option}: wanted another point of link {old.link}, got {name!r}")
    return other
