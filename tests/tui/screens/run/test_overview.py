from __future__ import annotations

from dataclasses import replace

import pytest
from support.made_run import AT_HIT, HIT_EVENTS, after, fresh, judged, prompted

from armodal.daq.events import HitWithdrawn
from armodal.daq.session_machine import hit_judged, skip
from armodal.tui.screens.run.overview import hits_left, missing, point_qualities, seconds_left


def of(*events):
    return after(fresh(), *HIT_EVENTS, *events)


def test_a_fresh_plan_has_everything_missing_and_no_time_to_tell():
    state = fresh()
    planned = sum(len(p.points) for p in state.plan.postures)
    assert hits_left(state) == planned * state.plan.hits_per_point
    assert sum(len(points) for _, points in missing(state)) == planned
    assert seconds_left(state) is None


def test_time_left_is_that_of_the_pace_so_far():
    # Hits 10 s apart at point 1, then 40 s to point 2, 10 s apart there.
    hits = [judged(i + 1, at_s=10.0 * i) for i in range(3)]
    hits += [judged(i + 4, at_s=60.0 + 10.0 * i, point="2") for i in range(3)]
    session = AT_HIT
    for _ in range(3):
        session = hit_judged(session, accepted=True)
    session = replace(session, at_posture=True, ready=True)
    for _ in range(3):
        session = hit_judged(session, accepted=True)
    state = of(*hits, prompted(session))
    points = len(state.progress) - 2
    expected = points * 40.0 + (3 * points - points) * 10.0
    assert seconds_left(state) == pytest.approx(expected)
    assert seconds_left(replace(state, time_scale=4.0)) == pytest.approx(expected / 4.0)


def test_rejected_and_withdrawn_hits_tell_on_the_quality_of_their_point():
    state = of(judged(1, "double"), judged(2), HitWithdrawn(number=2, posture="test 1", point="1"))
    assert point_qualities(state)[0].rejected == 2


def test_a_skipped_point_is_missing_but_asks_for_no_hit():
    state = of(prompted(skip(AT_HIT)))
    assert point_qualities(state)[0].mark == "-"
    assert "1" in dict(missing(state))["test 1"]
    assert hits_left(state) == hits_left(fresh()) - state.plan.hits_per_point


def test_a_point_that_took_many_tries_is_marked():
    rejects = [judged(i + 1, "double") for i in range(7)]
    session = AT_HIT
    for _ in range(3):
        session = hit_judged(session, accepted=True)
    state = of(*rejects, *(judged(i + 8) for i in range(3)), prompted(session))
    assert point_qualities(state)[0].mark == "!"
