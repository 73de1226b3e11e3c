"""What the marks of a journal tell of the way through the plan: what was skipped, where it stood.

The marks are in the order in which they were written. A point is begun by a POINT mark, also when
it is jumped to or retaken, and asked for again by a WITHDRAWN one.
"""

from __future__ import annotations

from collections.abc import Sequence

from armodal.protocols.plan_records import Plan
from armodal.protocols.session.journal_payloads import Mark, MarkKind
from armodal.protocols.session.progress import missing_points
from armodal.protocols.session.records import Hit

__all__ = ["place_in_hand", "skipped_points"]

_ASKED_FOR = frozenset({MarkKind.POINT, MarkKind.WITHDRAWN})


def skipped_points(
    plan: Plan, hits: Sequence[Hit], marks: Sequence[Mark]
) -> frozenset[tuple[str, str]]:
    """Return the planned (posture, point) that lack hits, were skipped and not begun since.

    Empty where nothing else lacks hits: who comes back to such a session wants what was skipped.
    """
    skipped: set[tuple[str, str]] = set()
    for mark in marks:
        places = _places(plan, mark)
        if mark.kind is MarkKind.SKIPPED:
            skipped.update(places)
        elif mark.kind in _ASKED_FOR:
            skipped.difference_update(places)
    missing = frozenset(missing_points(plan, hits))
    left = missing & skipped
    return left if missing - left else frozenset()


def place_in_hand(marks: Sequence[Mark]) -> tuple[str, str] | None:
    """Return posture and point that were begun last; None where no mark tells it."""
    for mark in reversed(marks):
        if mark.kind in _ASKED_FOR and mark.posture is not None and mark.point is not None:
            return mark.posture, mark.point
    return None


def _places(plan: Plan, mark: Mark) -> list[tuple[str, str]]:
    """Return the places a mark is of: one point, or all of a posture."""
    return [
        (posture.name, point)
        for posture in plan.postures
        if posture.name == mark.posture
        for point in posture.points
        if mark.point in {None, point}
    ]
