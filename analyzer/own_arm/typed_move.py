"""A test point moved by what an operator types, in mm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.moving import by_distances, measured_on_surface, on_surface
from armodal.analyzer.own_arm.of_arm import bodies_of_arm
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.remarks import Remarks

__all__ = ["typed_move"]

Array = npt.NDArray[np.float64]
MM = 1e-3


def typed_move(arm: Arm, folder: Path | None, point_id: str, typed: str) -> Point:
    """Return a point of the arm where the operator says it is.

    Parameters
    ----------
    folder
        Where the arm file and its meshes lie; without meshes the point keeps its axes.
    typed
        In mm: `20 0`, an offset along the sensor's x and y axes; `5:30`, so far towards point 5; or
        `4:120 5:300 6:200`, distances measured from three points of the link.

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
            "wanted an offset in mm along x and y as 20 0, a point and mm towards it as 5:30, or "
            f"three points and their distances as 4:120 5:300 6:200, got {typed!r}"
        )
    others = [_of_link(arm, old, name) for name, mark, _ in pairs if mark]
    body = next(
        (b for b in bodies_of_arm(arm, folder, Remarks()) or () if b.name == old.link), None
    )
    what, drawn = f"point {old.id}", body is not None and body.drawn
    place, axes = old.position_m, old.R_link_sensor
    if len(others) == 3:
        if body is not None and drawn:
            place, axes = measured_on_surface(body, others, numbers, what)
        else:
            both = by_distances(others, numbers, what)
            place = min(both, key=lambda one: float(np.linalg.norm(one - old.position_m)))
    else:
        if others:
            way = others[0] - old.position_m
            step = way * (numbers[0] / max(float(np.linalg.norm(way)), 1e-9))
        else:
            step = old.R_link_sensor[:, :2] @ np.array(numbers)
        place = old.position_m + step
        if body is not None and drawn:
            place, axes = on_surface(body, place, what)
    return Point(id=old.id, link=old.link, position_m=place, R_link_sensor=axes)


def _of_link(arm: Arm, old: Point, name: str) -> Array:
    for point in arm.points:
        if point.id == name and point.link == old.link and point.id != old.id:
            return point.position_m
    ids = ", ".join(p.id for p in arm.points if p.link == old.link and p.id != old.id)
    raise ArmError(f"wanted another point of link {old.link}: {ids or 'it has none'}; got {name!r}")
