from __future__ import annotations

import re

import pytest
from support.made_run import ARM, BOARD, HAMMER_PLAN, LAB_EVENTS, PLAN, after, fresh, judged, trial
from support.stage import Stage, play

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.errors import SessionError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import Mark, MarkKind, encode_hit, encode_mark
from armodal.protocols.session.records import SessionHeader
from armodal.tui.screens.run.place import find_place, with_trigger_level
from armodal.tui.screens.run.trials import FEWEST_TRIALS, suggested_level_n


def begun(path, plan=PLAN):
    header = SessionHeader(
        session_id="ab",
        created="2026-11-21T10:00:00+00:00",
        software="test",
        arm=ARM,
        plan=plan,
        dictionary=BOARD.dictionary,
        dictionary_bytes=encode_dictionary(BOARD.dictionary),
        channel_mask=BOARD.channel_mask,
        time_scale=1.0,
    )
    return JournalWriter.create(path, header)


def test_a_place_without_a_journal_begins_with_the_plan_given(tmp_path):
    place = find_place(tmp_path / "s.journal", ARM, PLAN)
    assert not place.begun
    assert place.plan is PLAN


def test_a_place_with_a_journal_goes_by_what_is_in_it(tmp_path):
    path = tmp_path / "s.journal"
    writer = begun(path)
    writer.append(encode_hit(judged(1).hit))
    writer.close()
    place = find_place(path, ARM, None)
    assert place.begun
    assert place.plan.sha256 == PLAN.sha256
    assert [hit.number for hit in place.hits] == [1]
    assert place.ended is None  # it was never closed


def test_a_hit_taken_back_is_asked_for_again_on_return(tmp_path):
    path = tmp_path / "s.journal"
    writer = begun(path)
    writer.append(encode_hit(judged(1).hit))
    mark = Mark(kind=MarkKind.WITHDRAWN, posture="test 1", point="1", host_s=1.0, hit=1)
    writer.append(encode_mark(mark))
    writer.close()
    (hit,) = find_place(path, ARM, None).hits
    assert not hit.verdict.accepted


def test_another_plan_than_the_journals_is_refused(tmp_path):
    path = tmp_path / "s.journal"
    begun(path).close()
    with pytest.raises(SessionError, match="leave the plan"):
        find_place(path, ARM, HAMMER_PLAN)


def test_neither_journal_nor_plan_is_refused_with_an_example(tmp_path):
    with pytest.raises(SessionError, match="armodal run rv4frl-three-postures"):
        find_place(tmp_path / "s.journal", ARM, None)


def test_a_trigger_level_taken_is_in_the_plans_text():
    plan = with_trigger_level(PLAN, ARM, 12.5)
    assert plan.trigger.level_n == 12.5
    assert plan.sha256 != PLAN.sha256
    assert "level_n = 12.5" in plan.text
    assert plan.postures[0].points == PLAN.postures[0].points


INLINE = re.sub(r"\[trigger\]\n.*\n.*\n", "", PLAN.text).replace(
    "hits_per_point", 'trigger = { level_n = 10.0, slope = "rising" }\nhits_per_point', 1
)


@pytest.mark.parametrize("before", ["", "# level_n = 3.0 was too low\n"])
def test_a_trigger_level_is_taken_where_armodal_plan_writes_it(before):
    plan = plan_from_text(before + INLINE, ARM, origin="inline")
    changed = with_trigger_level(plan, ARM, 12.5)
    assert changed.trigger.level_n == 12.5
    assert changed.text == plan.text.replace("level_n = 10.0", "level_n = 12.5")


def test_a_trigger_level_that_cannot_be_taken_is_one_notice(tmp_path):
    quoted = INLINE.replace("level_n =", '"level_n" =')
    stage = Stage(tmp_path, plan=plan_from_text(quoted, ARM, origin="quoted"))

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS, *[trial(90.0)] * FEWEST_TRIALS)
        await pilot.press("a")
        await pilot.pause()
        (notice,) = stage.notices
        assert "wanted level_n" in notice
        assert stage.app.conductor.place.plan.trigger.level_n == 10.0
        assert stage.sent == []

    play(stage, body)


def test_too_few_trial_hits_suggest_nothing():
    assert suggested_level_n(after(fresh(), *[trial()] * (FEWEST_TRIALS - 1))) is None


def test_the_level_is_a_tenth_of_the_peaks_and_clear_of_the_noise():
    assert suggested_level_n(after(fresh(), *[trial(90.0)] * 3)) == 9.0
    assert suggested_level_n(after(fresh(), *[trial(90.0, noise_n=2.0)] * 3)) == 16.0
