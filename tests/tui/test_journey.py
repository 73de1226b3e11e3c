"""From screen to screen: each step's wish is the next step."""

from __future__ import annotations

from pathlib import Path

import pytest

from armodal.protocols.errors import SessionError
from armodal.tui.journey import travel
from armodal.tui.screens.wishes import GoHome, Look, Measure

MEASURE = Measure(journal=Path("a.journal"), arm="rv4frl", plan=None, simulated=True)
LOOK = Look(session=Path("a.h5"))


def steps(**answers):
    """Steps that note what was shown, and answer in turn."""
    shown = []

    def step(wish):
        shown.append(wish)
        answer = answers[type(wish).__name__].pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    return shown, dict.fromkeys((GoHome, Look, Measure), step)


def test_a_journey_goes_from_wish_to_wish_and_ends_with_the_last_code():
    shown, known = steps(Measure=[(0, LOOK)], Look=[(7, None)])
    assert travel(MEASURE, known) == 7
    assert shown == [MEASURE, LOOK]


def test_what_begins_at_home_comes_home_until_home_is_left():
    shown, known = steps(GoHome=[(0, MEASURE), (0, None)], Measure=[(0, LOOK)], Look=[(0, None)])
    assert travel(GoHome(), known) == 0
    assert shown == [GoHome(), MEASURE, LOOK, GoHome()]


def test_what_fails_is_said_at_home_and_raised_without_one():
    shown, known = steps(GoHome=[(0, LOOK), (0, None)], Look=[SessionError("torn")])
    travel(GoHome(), known)
    assert shown == [GoHome(), LOOK, GoHome(said="torn")]
    _, known = steps(Look=[SessionError("torn")])
    with pytest.raises(SessionError):
        travel(LOOK, known)
