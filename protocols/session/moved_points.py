"""Test points that the operator has moved in a session, before anything was measured at them.

The journal's HEADER holds the arm file as the session began with it. A MARK of kind note that
begins with `point moved: ` holds a point's place since; the session that is read from the journal
has the arm with all points where they were measured.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

import numpy as np

from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.arm.rewrite import text_with_point
from armodal.protocols.errors import ArmodalError, JournalError
from armodal.protocols.session.journal_payloads import Mark, MarkKind

__all__ = [
    "MOVED",
    "arm_with_moves",
    "arm_with_point",
    "move_note",
    "move_words",
    "moved_points",
]

MOVED = "point moved: "


def arm_with_point(arm: Arm, point: Point) -> Arm:
    """Return the arm with one of its points elsewhere, in its text too.

    Raises
    ------
    ArmError
        If the arm has no such point, or its text cannot be rewritten.
    """
    return arm_from_texts(
        text_with_point(arm, point),
        urdf_text=arm.urdf_text,
        database_text=None if arm.can is None else arm.can.database_text,
        origin=f"arm {arm.name}",
    )


def move_note(point: Point) -> str:
    """Return the note that keeps a move: id, place (m) and axes z and x in the link's frame."""
    numbers = {
        "position_m": [round(float(value), 5) for value in point.position_m],
        "normal": [round(float(value), 6) for value in point.R_link_sensor[:, 2]],
        "x_axis": [round(float(value), 6) for value in point.R_link_sensor[:, 0]],
    }
    return MOVED + json.dumps({"id": point.id} | numbers)


def arm_with_moves(arm: Arm, marks: Iterable[Mark]) -> Arm:
    """Return the arm with the points where the journal's marks have put them.

    Raises
    ------
    JournalError
        If a mark moves a point that the arm has not, or to no place.
    """
    for mark in marks:
        if mark.kind is MarkKind.NOTE and mark.note.startswith(MOVED):
            arm = arm_with_point(arm, _read(mark.note, arm))
    return arm


def moved_points(arm: Arm, moved: Arm) -> tuple[Point, ...]:
    """Return the points that are elsewhere in the second arm, where they are there."""
    pairs = zip(arm.points, moved.points, strict=True)
    return tuple(new for old, new in pairs if not np.array_equal(old.position_m, new.position_m))


def move_words(arm: Arm, moved: Arm) -> tuple[str, ...]:
    """Say of each point that was moved by how much."""
    said = []
    for new in moved_points(arm, moved):
        shift_m = float(np.linalg.norm(new.position_m - arm.point(new.id).position_m))
        said.append(f"point {new.id} was moved by {1e3 * shift_m:.0f} mm before it was measured")
    return tuple(said)


def _read(note: str, arm: Arm) -> Point:
    try:
        told = json.loads(note.removeprefix(MOVED))
        old = arm.point(told["id"])
        place, z, x = (
            np.array(told[key], dtype=np.float64).reshape(3)
            for key in ("position_m", "normal", "x_axis")
        )
    except (ArmodalError, KeyError, TypeError, ValueError) as problem:
        raise JournalError(f"a mark moves no point of the arm: {note[:80]!r}") from problem
    axes = np.column_stack([x, np.cross(z, x), z])
    return Point(id=old.id, link=old.link, position_m=place, R_link_sensor=axes)
