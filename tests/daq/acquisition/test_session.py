"""A session from its start to its end: points, prompts, resuming, what is kept."""

import multiprocessing
from dataclasses import replace

import numpy as np
import pytest
from support.acquisition_run import strike

from armodal.daq.commands import MovePoint, Note, Retake, Skip, Withdraw
from armodal.daq.events import Finished, HitWithdrawn, PointMoved, SessionOpened
from armodal.daq.session_machine import PromptKind
from armodal.protocols.session.journal import load_journal, read_journal, session_of


def test_a_session_goes_from_posture_to_a_complete_journal(lab, start, fakes):
    run = start()
    for point in ("2", "3"):
        prompt = run.ready()
        assert (prompt.sensor_point, prompt.hit_point) == (point, "1")
        for _ in range(2):
            strike(lab, fakes["record"]())
            assert run.judged().verdict.accepted
    finished = run.until(lambda e: isinstance(e, Finished))
    assert finished.complete
    assert finished.accepted == 4
    session = load_journal(lab.journal)
    assert session.complete
    np.testing.assert_array_equal(session.hits[0].counts, fakes["record"]())
    assert lab.board.released == [1, 2, 3, 4]


def test_a_laboratory_whose_clock_runs_faster_is_measured_all_the_same(lab, start, fakes):
    lab.board.scale = lab.controller.scale = 16.0
    run = start(time_scale=16.0)
    run.ready()
    strike(lab, fakes["record"]())
    hit = run.judged()
    assert hit.verdict.accepted, hit.verdict
    # The fake says when it was struck, in ticks of the lab's clock: microseconds.
    assert hit.trigger_host_s == pytest.approx(lab.board.struck_s, abs=0.05)


def test_leaving_the_posture_is_asked_back(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    here = lab.controller.joints_rad
    lab.controller.joints_rad = here + np.radians(2.0)
    run.prompt(PromptKind.POSTURE)
    lab.controller.joints_rad = here
    run.prompt(PromptKind.POINT)


def test_skip_and_retake_move_between_points(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(Skip(reason="hidden"))
    assert run.prompt(PromptKind.POINT).sensor_point == "3"
    run.ours.send(Retake(posture="test 1", point="2"))
    assert run.prompt(PromptKind.POINT).sensor_point == "2"
    run.end()
    assert "skipped: posture test 1, point 2: hidden" in load_journal(lab.journal).warnings


def test_an_interrupted_session_goes_on_where_it_was(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    run.judged()
    run.end()
    torn = lab.journal.read_bytes()
    lab.journal.write_bytes(torn + b"half a record")
    again = start(resume=True)
    opened = again.until(lambda e: isinstance(e, SessionOpened))
    assert opened.hits_before == 1
    assert again.ready().accepted == 1
    strike(lab, fakes["record"]())
    assert again.judged().number == 2
    again.end()
    assert len(load_journal(lab.journal).hits) == 2
    aside = lab.journal.with_name(lab.journal.name + ".torn-1")
    assert aside.read_bytes() == b"half a record"


def test_a_session_come_back_to_has_not_forgotten_what_was_skipped(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(Skip(reason="hidden"))
    assert run.prompt(PromptKind.POINT).sensor_point == "3"
    run.end()
    again = start(resume=True)
    assert again.prompt(PromptKind.POSTURE).sensor_point == "3"


def test_a_jump_left_before_its_first_hit_is_gone_on_with(lab, start):
    run = start()
    assert run.prompt(PromptKind.POINT).sensor_point == "2"
    run.ours.send(Retake(posture="test 1", point="3"))
    assert run.prompt(PromptKind.POINT).sensor_point == "3"
    run.end()
    again = start(resume=True)
    assert again.prompt(PromptKind.POSTURE).sensor_point == "3"


def test_who_comes_back_to_nothing_but_skipped_points_is_asked_for_them(lab, start):
    run = start()
    for _ in range(2):
        run.prompt(PromptKind.POINT)
        run.ours.send(Skip(reason="hidden"))
    run.until(lambda e: isinstance(e, Finished))
    run.end()
    again = start(resume=True)
    assert again.prompt(PromptKind.POSTURE).sensor_point == "2"


def test_a_session_of_skipped_points_ends_and_is_not_told_to_be_complete(lab, start):
    run = start()
    for _ in range(2):
        run.prompt(PromptKind.POINT)
        run.ours.send(Skip(reason="hidden"))
    finished = run.until(lambda e: isinstance(e, Finished))
    run.end()
    journal = read_journal(lab.journal)
    assert not finished.complete
    assert not session_of(journal).complete
    assert journal.end.reason == finished.reason
    assert "2 of 2 planned points were skipped" in finished.reason


def test_a_mirror_holds_the_whole_session_and_goes_on_with_it(lab, start, tmp_path):
    mirror = tmp_path / "disk"
    mirror.mkdir()
    run = start(mirror=mirror)
    run.prompt(PromptKind.POINT)
    run.ours.send(Skip(reason="hidden"))
    run.prompt(PromptKind.POINT)
    run.ours.close()
    run.thread.join(8.0)
    run.ours, _ = multiprocessing.Pipe()
    copy = mirror / lab.journal.name
    assert copy.read_bytes() == lab.journal.read_bytes()
    lab.journal.unlink()
    again = start(resume=True, mirror=mirror)
    again.prompt(PromptKind.POINT)
    again.ours.close()
    again.thread.join(8.0)
    again.ours, _ = multiprocessing.Pipe()
    assert copy.read_bytes() == lab.journal.read_bytes()


def test_the_listener_going_away_ends_the_session_cleanly(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.close()
    run.thread.join(8.0)
    assert run.code == 0
    assert read_journal(lab.journal).end is not None
    run.ours, _ = multiprocessing.Pipe()


def test_roving_hammer_leaves_the_sensor_and_moves_the_hit(lab, start, fakes, hammer_plan):
    lab.plan = hammer_plan
    run = start(plan=hammer_plan)
    prompt = run.ready()
    assert (prompt.sensor_point, prompt.hit_point) == ("1", "2")
    strike(lab, fakes["record"]())
    hit = run.judged()
    # A unit vector within rounding of its three products.
    assert np.linalg.norm(hit.hit_direction) == pytest.approx(1.0, abs=1e-12)


def test_nothing_but_the_opening_commands_is_ever_written_to_the_bus(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    run.judged()
    run.end()
    assert lab.controller.commands == [b"C", b"S6", b"L"]


def test_a_hit_taken_back_stays_in_the_journal_and_counts_no_more(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted
    run.ours.send(Withdraw())
    assert run.until(lambda e: isinstance(e, HitWithdrawn)).number == 1
    assert run.prompt(PromptKind.HIT).accepted == 0
    run.end()
    (hit,) = load_journal(lab.journal).hits
    assert hit.verdict.reasons == ("withdrawn",)
    again = start(resume=True)
    assert again.ready().accepted == 0


def test_nothing_to_take_back_is_said(lab, start):
    run = start()
    run.ready()
    run.ours.send(Withdraw())
    run.noted("no accepted hit")


def test_a_point_moved_before_its_hits_is_there_in_the_session_and_when_it_goes_on(
    lab, start, fakes
):
    run = start()
    point = lab.arm.point(run.ready().sensor_point)
    moved = replace(point, position_m=point.position_m + np.array([0.0, 0.0, 0.03]))
    run.ours.send(MovePoint(point=moved))
    told = run.until(lambda e: isinstance(e, PointMoved))
    np.testing.assert_allclose(told.arm.point(point.id).position_m, moved.position_m, atol=5e-6)
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted
    run.ours.send(MovePoint(point=point))
    run.noted("has accepted hits and stays where it is")
    run.end()
    # A session that goes on is asked for with the arm file it was begun with.
    again = start(resume=True)
    again.ready()
    again.end()
    session = load_journal(lab.journal)
    np.testing.assert_allclose(
        session.header.arm.point(point.id).position_m, moved.position_m, atol=5e-6
    )
    assert f"point {point.id} was moved by 30 mm before it was measured" in session.warnings
    assert read_journal(lab.journal).header.arm.sha256 == lab.arm.sha256


def test_what_the_operator_notes_is_in_the_journal(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(Note(text="the hammer's tip was changed"))
    run.noted("tip was changed")
    run.end()
    assert "the hammer's tip was changed" in [m.note for m in read_journal(lab.journal).marks]
