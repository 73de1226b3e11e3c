"""A test point moved by what an operator types, in mm."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from armodal.analyzer.own_arm.moving import by_distances, measured_on_surface, on_surface
from armodal.analyzer.own_arm.of_arm import bodies_of_arm
from armodal.analyzer.own_arm.towards import point_named, step_towards
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.remarks import Remarks

__all__ = ["typed_move"]

MM = 1e-3


def typed_move(arm: Arm, folder: Path | None, point_id: str, typed: str) -> Point:
    """Return a point of the arm where the operator says it is.

    Parameters
    ----------
    folder
        Where the arm file and its meshes lie; without meshes the point keeps its axes.
    typed
        In mm: `20 0`, an offset along the sensor's x and y axes; `5:30`, so far towards point 5;
        `J3:30` or the joint's name, so far towards its axis; or `4:120 5:300 6:200`, distances
        measured from three points of the link.

    Raises
    ------
    ArmError
        If the words are none of these, or the place is not on the link.
    """
    old = arm.point(point_id)
    parts = typed.replace(",", " ").split()
    pairs = [part.rpartition(":") for part in parts]
    marked = sum(bool(mark) for _, mark, _ in pairs)
    try:
        numbers = [float(number) * MM for _, _, number in pairs]
    except ValueError:
        numbers = []
    if not np.isfinite(numbers).all() or (len(numbers), marked) not in {(2, 0), (1, 1), (3, 3)}:
        raise ArmError(
            "wanted an offset in mm along x and y as 20 0, a point or joint and mm towards it as "
            "5:30 or J3:30, or three points and their distances as 4:120 5:300 6:200, "
            f"got {typed!r}"
        )
    body = next(
        (b for b in bodies_of_arm(arm, folder, Remarks()) or () if b.name == old.link), None
    )
    what, drawn = f"point {old.id}", body is not None and body.drawn
    place, axes = old.position_m, old.R_link_sensor
    if marked == 3:
        others = [point_named(arm, old, name) for name, _, _ in pairs]
        if body is not None and drawn:
            place, axes = measured_on_surface(body, others, numbers, what)
        else:
            both = by_distances(others, numbers, what)
            place = min(both, key=lambda one: float(np.linalg.norm(one - old.position_m)))
    else:
        if marked:
            step = step_towards(arm, old, pairs[0][0], numbers[0])
        else:
            step = old.R_link_sensor[:, :2] @ np.array(numbers)
        place = old.position_m + step
        if body is not None and drawn:
            place, axes = on_surface(body, place, what)
    return Point(id=old.id, link=old.link, position_m=place, R_link_sensor=axes)
