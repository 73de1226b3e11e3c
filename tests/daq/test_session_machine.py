from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.daq import session_machine as machine
from armodal.daq.session_machine import PromptKind, SessionState
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.records import Hit, JointReading, Verdict

ARM = load_arm("rv4frl")
PLAN = load_plan("rv4frl-three-postures", ARM)


def at_hit(state: SessionState) -> SessionState:
    return machine.point_ready(machine.posture_reached(state))


def test_posture_then_point_then_hit_then_the_next_point():
    state = machine.begin(PLAN)
    assert state.kind is PromptKind.POSTURE
    state = machine.posture_reached(state)
    assert state.kind is PromptKind.POINT
    state = machine.point_ready(state)
    assert state.kind is PromptKind.HIT
    for _ in range(PLAN.hits_per_point):
        assert state.prompt.sensor_point == PLAN.postures[0].points[0]
        state = machine.hit_judged(state, accepted=True)
    assert state.kind is PromptKind.POINT
    assert state.prompt.sensor_point == PLAN.postures[0].points[1]


def test_every_planned_point_is_visited_once_in_order():
    state = machine.begin(PLAN)
    visited = []
    while state.kind is not PromptKind.DONE:
        state = at_hit(state)
        here = state.here
        assert here is not None
        visited.append((here.posture, here.point))
        for _ in range(PLAN.hits_per_point):
            state = machine.hit_judged(state, accepted=True)
    assert visited == [(p.name, point) for p in PLAN.postures for point in p.points]
    assert sum(p.complete for p in state.progress) == len(state.progress) == len(visited)


def test_a_new_posture_is_asked_for_after_the_last_point_of_the_old():
    state = machine.begin(PLAN)
    for _ in PLAN.postures[0].points:
        state = machine.skip(at_hit(state))
    assert state.kind is PromptKind.POSTURE
    assert state.posture == PLAN.postures[1]


def test_rejects_count_as_attempts_and_never_as_hits():
    state = at_hit(machine.begin(PLAN))
    for k in range(PLAN.max_attempts):
        assert not state.prompt.exhausted, k
        state = machine.hit_judged(state, accepted=False)
    assert state.prompt.exhausted
    assert state.prompt.accepted == 0
    assert not machine.retake(state).prompt.exhausted


def test_leaving_the_posture_keeps_what_is_mounted():
    state = machine.posture_left(at_hit(machine.begin(PLAN)))
    assert state.kind is PromptKind.POSTURE
    assert machine.posture_reached(state).kind is PromptKind.HIT


def test_ready_means_nothing_away_from_the_posture():
    state = machine.begin(PLAN)
    assert machine.point_ready(state) == state


def test_retaking_a_complete_point_asks_for_as_many_again():
    state = at_hit(machine.begin(PLAN))
    for _ in range(PLAN.hits_per_point):
        state = machine.hit_judged(state, accepted=True)
    first = PLAN.postures[0]
    state = machine.retake(state, first.name, first.points[0])
    assert state.kind is PromptKind.POINT
    assert state.prompt.wanted == 2 * PLAN.hits_per_point
    with pytest.raises(KeyError):
        machine.retake(state, "nowhere", "99")


def test_roving_hammer_moves_the_hit_and_leaves_the_sensor():
    plan = load_plan("rv4frl-roving-hammer", ARM)
    prompt = machine.begin(plan).prompt
    assert prompt.sensor_point == plan.fixed_point
    assert prompt.hit_point == plan.postures[0].points[0]


def test_a_session_lacks_its_skipped_points_and_not_what_a_retake_asked_beyond_the_plan():
    state = at_hit(machine.begin(PLAN))
    for _ in range(PLAN.hits_per_point):
        state = machine.hit_judged(state, accepted=True)
    while state.kind is not PromptKind.DONE:
        state = machine.skip(at_hit(state))
    total = len(state.progress)
    assert state.lacking == total - 1
    first = PLAN.postures[0]
    state = machine.skip(machine.retake(state, first.name, first.points[0]))
    assert state.kind is PromptKind.DONE
    assert state.lacking == total - 1


STEPS = st.lists(
    st.sampled_from(["reached", "left", "ready", "good", "bad", "skip", "retake"]), max_size=200
)


@given(steps=STEPS)
def test_no_sequence_of_steps_loses_a_hit_or_leaves_the_plan(steps):
    state = machine.begin(PLAN)
    accepted = 0
    for step in steps:
        if step == "reached":
            state = machine.posture_reached(state)
        elif step == "left":
            state = machine.posture_left(state)
        elif step == "ready":
            state = machine.point_ready(state)
        elif step in {"good", "bad"} and state.kind is PromptKind.HIT:
            accepted += step == "good"
            state = machine.hit_judged(state, accepted=step == "good")
        elif step == "skip":
            state = machine.skip(state)
        elif step == "retake":
            state = machine.retake(state)
        assert sum(p.accepted for p in state.progress) == accepted
        done = all(p.complete for p in state.progress)
        assert (state.kind is PromptKind.DONE) == done


def test_a_withdrawn_hit_is_asked_for_again_where_the_sensor_still_sits(plan):
    state = machine.point_ready(machine.posture_reached(machine.begin(plan)))
    state = machine.hit_judged(state, accepted=True)
    back = machine.withdraw(state, "test 1", "2")
    assert back.kind is PromptKind.HIT
    assert back.prompt.accepted == 0


def test_a_hit_withdrawn_after_the_sensor_went_on_asks_for_the_sensor_first(plan):
    state = machine.point_ready(machine.posture_reached(machine.begin(plan)))
    for _ in range(plan.hits_per_point):
        state = machine.hit_judged(state, accepted=True)
    assert state.prompt.sensor_point == "3"
    back = machine.withdraw(state, "test 1", "2")
    assert back.kind is PromptKind.POINT
    assert (back.prompt.sensor_point, back.prompt.accepted) == ("2", plan.hits_per_point - 1)


def accepted(posture: str, point: str) -> Hit:
    reading = JointReading(joints_rad=None, drive_state=None, held=True, age_s=0.0, host_s=0.0)
    return Hit(
        number=1,
        posture=posture,
        sensor_point=point,
        hit_point=PLAN.fixed_point,
        hit_direction=np.array([0.0, 0.0, 1.0]),
        first_sample=0,
        trigger_sample=0,
        trigger_host_s=0.0,
        counts=np.zeros((2, 1), dtype=np.int32),
        before=reading,
        after=reading,
        verdict=Verdict(accepted=True, reasons=(), notes=(), peak_n=1.0, width_s=1e-3),
    )


def test_an_interrupted_session_goes_on_at_the_point_hit_last():
    posture = PLAN.postures[0]
    state = machine.begin(PLAN, [accepted(posture.name, posture.points[2])])
    assert state.here is not None
    assert state.here.point == posture.points[2]
    assert state.here.accepted == 1


def test_after_a_finished_point_an_interrupted_session_goes_on_at_the_first_that_lacks_hits():
    posture = PLAN.postures[0]
    state = machine.begin(PLAN, [accepted(posture.name, posture.points[2])] * PLAN.hits_per_point)
    assert state.here is not None
    assert state.here.point == posture.points[0]
