"""What marks tell of the way through the plan."""

from __future__ import annotations

import pytest

from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.journal_payloads import Mark, MarkKind
from armodal.protocols.session.steps import place_in_hand, skipped_points

ARM = load_arm("rv4frl")
PLAN = load_plan("rv4frl-three-postures", ARM)
FIRST = PLAN.postures[0]
A, B = ((FIRST.name, point) for point in FIRST.points[:2])


def mark(kind, place=(None, None)):
    return Mark(kind=kind, posture=place[0], point=place[1], host_s=1.0)


def test_a_skipped_point_stays_skipped_until_it_is_begun_again():
    marks = [mark(MarkKind.POINT, A), mark(MarkKind.SKIPPED, A)]
    assert skipped_points(PLAN, (), marks) == {A}
    assert skipped_points(PLAN, (), [*marks, mark(MarkKind.POINT, B)]) == {A}
    assert skipped_points(PLAN, (), [*marks, mark(MarkKind.POINT, A)]) == frozenset()
    assert skipped_points(PLAN, (), [*marks, mark(MarkKind.WITHDRAWN, A)]) == frozenset()


def test_a_skipped_posture_is_all_its_points():
    marks = [mark(MarkKind.SKIPPED, (FIRST.name, None))]
    assert skipped_points(PLAN, (), marks) == {(FIRST.name, point) for point in FIRST.points}


def test_what_was_skipped_is_asked_for_again_when_nothing_else_is_left():
    marks = [mark(MarkKind.SKIPPED, (posture.name, None)) for posture in PLAN.postures]
    assert skipped_points(PLAN, (), marks[:-1])
    assert skipped_points(PLAN, (), marks) == frozenset()


@pytest.mark.parametrize("place", [(None, None), ("nowhere", "99")])
def test_a_skip_of_nothing_planned_skips_nothing(place):
    marks = [mark(MarkKind.SKIPPED, place)]
    assert skipped_points(PLAN, (), marks) == frozenset()


def test_the_place_in_hand_is_the_one_begun_last():
    assert place_in_hand(()) is None
    assert place_in_hand([mark(MarkKind.NOTE, A)]) is None
    begun = [mark(MarkKind.POINT, A), mark(MarkKind.POINT, B), mark(MarkKind.NOTE, A)]
    assert place_in_hand(begun) == B
    assert place_in_hand([*begun, mark(MarkKind.WITHDRAWN, A)]) == A
