"""What the operator is asked for on the screens, and what his answers tell the acquisition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.made_run import (
    ARM,
    AT_HIT,
    AT_POINT,
    HAMMER_PLAN,
    HIT_EVENTS,
    LAB_EVENTS,
    PLAN,
    SESSION_EVENTS,
    prompted,
    reading,
)
from support.stage import Stage, play

from armodal.daq.commands import MovePoint, Note, Ready, Retake, Skip, StatedPosture, Withdraw
from armodal.daq.events import PointMoved
from armodal.daq.session_machine import begin, hit_judged, point_ready, posture_reached
from armodal.protocols.plan_records import KnownMass
from armodal.protocols.session.moved_points import arm_with_point
from armodal.tui.operators import request_for
from armodal.tui.screens.run import conductor
from armodal.tui.screens.run.happenings import (
    HandAtWork,
    HandIdle,
    SafeConfirmed,
)
from armodal.tui.screens.run.keys import works
from armodal.tui.screens.run.state import Phase
from armodal.tui.screens.run.step_screen import Pane


def test_enter_confirms_safety_first_and_then_says_ready(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS, prompted(AT_POINT))
        await pilot.press("enter")
        await stage.settle(pilot)
        assert stage.app.state.safe
        assert isinstance(stage.sent[0], Note)
        await pilot.press("enter")
        await stage.settle(pilot)
        assert isinstance(stage.sent[1], Ready)

    play(stage, body)


def test_a_point_is_moved_where_it_is_typed_and_shown_there_once_the_acquisition_says_so(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS, prompted(AT_POINT))
        point = ARM.point(stage.app.state.here[1])
        await pilot.press("m", *"far", "enter")
        await pilot.app.workers.wait_for_complete()
        await stage.settle(pilot)
        assert stage.sent == []
        assert "wanted an offset in mm" in stage.notices[-1]
        await pilot.press("m", "0", "space", "2", "0", "enter")
        await pilot.app.workers.wait_for_complete()
        await stage.settle(pilot)
        (sent,) = stage.sent
        assert isinstance(sent, MovePoint)
        np.testing.assert_allclose(
            sent.point.position_m, point.position_m + 0.02 * point.R_link_sensor[:, 1]
        )
        moved = arm_with_point(ARM, sent.point)
        await stage.tell(pilot, PointMoved(point=point.id, arm=moved))
        assert stage.app.state.arm is moved

    play(stage, body)


class Laboratory:
    """A laboratory whose hand notes what it is asked to do."""

    board, can, input_range_v = "/dev/pts/a", "/dev/pts/b", 10.0

    def __init__(self, *_args, **_options):
        self.laboratory, self.hand, self.alive, self.asked = self, self, True, []

    def do(self, request, words):
        self.asked.append((request, words))

    def failure(self):
        return None

    def close(self):
        self.alive = False


def test_in_the_simulated_laboratory_a_moved_point_is_marked_where_it_is(tmp_path, monkeypatch):
    laboratory = Laboratory()
    monkeypatch.setattr(conductor, "SimulatedLab", lambda *_args, **_options: laboratory)
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.app.conductor.simulate()
        await stage.tell(pilot, *SESSION_EVENTS, prompted(AT_POINT))
        old = ARM.point(stage.app.state.here[1])
        await pilot.press("m", *"0", "space", *"20", "enter")
        await pilot.app.workers.wait_for_complete()
        await stage.settle(pilot)
        moved = arm_with_point(ARM, stage.sent[-1].point)
        assert laboratory.asked == []  # not before the acquisition has taken it
        await stage.tell(pilot, PointMoved(point=old.id, arm=moved))
        ((request, words),) = laboratory.asked
        assert (request["do"], request["point"]) == ("mark", old.id)
        assert words == f"marks point {old.id} anew"
        new = moved.point(old.id)
        np.testing.assert_array_equal(request["position_m"], new.position_m)
        np.testing.assert_array_equal(request["normal"], new.R_link_sensor[:, 2])
        np.testing.assert_array_equal(request["x_axis"], new.R_link_sensor[:, 0])

    play(stage, body)


def test_a_point_is_not_moved_while_the_hand_is_at_work(tmp_path):
    stage = Stage(tmp_path)
    state = replace(stage.app.state, phase=Phase.SESSION, prompt=AT_POINT.prompt)
    assert works("move", state, overview=False)
    assert not works("move", replace(state, hand_doing="hits"), overview=False)


def test_enter_does_nothing_while_the_arm_is_on_its_way(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS)
        await pilot.press("enter")
        await stage.settle(pilot)
        assert not stage.app.state.safe
        assert stage.sent == []

    play(stage, body)


def test_retake_skip_undo_and_jump_are_told_to_the_acquisition(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, prompted(hit_judged(AT_HIT, accepted=True)))
        await pilot.press("t", "k", "u", "g")
        await stage.settle(pilot)
        await pilot.press("right", "right", "enter")
        await stage.settle(pilot)
        assert [type(command) for command in stage.sent] == [Retake, Skip, Withdraw, Retake]
        assert stage.sent[-1] == Retake(posture="test 1", point="3")

    play(stage, body)


def test_roving_hammer_marks_the_point_to_hit_and_leaves_the_sensor(tmp_path):
    stage = Stage(tmp_path, plan=HAMMER_PLAN)
    at_posture = begin(HAMMER_PLAN)
    at_point = posture_reached(at_posture)

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS, *SESSION_EVENTS[len(LAB_EVENTS) : -2])
        moving_on = hit_judged(point_ready(at_point), accepted=True)
        for _ in range(2):
            moving_on = hit_judged(moving_on, accepted=True)
        await stage.tell(
            pilot, prompted(at_posture), reading(), prompted(moving_on), SafeConfirmed()
        )
        assert "Sensor stays at point 1" in stage.text()
        assert "Hit point 3 next" in stage.text()
        assert "◉ 3" in stage.text()

    play(stage, body)


def test_enter_waits_for_the_simulated_hand_that_mounts_the_sensor(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        mounting = HandAtWork(doing="mounts the sensor at 1")
        await stage.tell(pilot, *SESSION_EVENTS, prompted(AT_POINT), SafeConfirmed(), mounting)
        assert "Enter" not in stage.app.screen.query_one("#instructions", Pane).plain
        await pilot.press("enter")
        await stage.settle(pilot)
        assert stage.sent == []
        await stage.tell(pilot, HandIdle())
        await pilot.press("enter")
        await stage.settle(pilot)
        assert [type(command) for command in stage.sent] == [Ready]

    play(stage, body)


def test_how_hard_the_plan_wants_the_next_hit_is_said_and_told_the_simulated_hand(tmp_path):
    first = replace(PLAN.postures[0], peaks_n=(10.0, 40.0, 160.0))
    plan = replace(PLAN, postures=(first, *PLAN.postures[1:]))
    stage = Stage(tmp_path, plan=plan)
    at_point = point_ready(posture_reached(begin(plan)))

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, prompted(at_point))
        assert "hits at point 1, next 10 N" in stage.text()
        assert "Hit point 1, about 10 N" in stage.text()

    play(stage, body)
    request, _ = request_for(ARM, at_point.prompt)
    assert request["peak_n"] == 10.0
    again, _ = request_for(ARM, replace(at_point.prompt, accepted=2))
    assert again["peak_n"] == 160.0
    any_peak, _ = request_for(ARM, replace(at_point.prompt, posture=PLAN.postures[0]))
    assert "peak_n" not in any_peak


def test_brakes_and_a_known_mass_that_the_plan_wants_are_said_with_the_posture(tmp_path):
    mass = KnownMass(link="wrist", mass_kg=2.5, center_m=np.array([0.0, 0.01, 0.1]))
    first = replace(PLAN.postures[0], brakes=True, known_mass=mass)
    plan = replace(PLAN, postures=(first, *PLAN.postures[1:]))
    stage = Stage(tmp_path, plan=plan)
    at_posture = begin(plan)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS, prompted(at_posture))
        told = " Brakes on. Bolt 2.5 kg to wrist, its centre at 0, 10, 100 mm in its frame."
        assert told in stage.text()
        await stage.tell(pilot, prompted(posture_reached(at_posture)))
        assert f"At its posture, held.{told} Look" in stage.text()

    play(stage, body)


def test_angles_by_hand_are_confirmed_or_typed(tmp_path):
    stage = Stage(tmp_path, told_rad=np.radians(0.2))

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS, reading(None))
        assert "none: you read the joint angles, to 0.2°" in stage.text()
        assert "Are these sensors mounted" in stage.text()  # no controller is waited for
        await stage.tell(pilot, *SESSION_EVENTS[len(LAB_EVENTS) :], reading(None))
        assert "Enter: it stands as wanted, by your reading to 0.2°, and is held" in stage.text()
        await pilot.press("enter")
        assert stage.sent == [StatedPosture()]
        await pilot.press("e")
        await pilot.pause()
        await pilot.press(*"-25 90 0 0", "enter")
        await pilot.pause()
        assert len(stage.sent) == 1  # two are missing
        await pilot.press(*" 90 0.1", "enter")
        await stage.settle(pilot)
        assert np.degrees(stage.sent[1].joints_rad) == pytest.approx([-25, 90, 0, 0, 90, 0.1])
        await stage.tell(pilot, prompted(AT_POINT), reading())
        assert "At its posture, held as you said." in stage.text()
        await pilot.press("e", "enter")
        await stage.settle(pilot)
        assert stage.app.state.safe
        assert isinstance(stage.sent[2], Note)

    play(stage, body)


def test_measured_angles_are_not_asked_for(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS)
        await pilot.press("e", "enter")
        await stage.settle(pilot)
        assert stage.sent == []

    play(stage, body)
