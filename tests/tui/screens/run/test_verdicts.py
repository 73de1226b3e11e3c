"""A hit's verdict on the screens, and the end of a session with its last one."""

from __future__ import annotations

import asyncio

import pytest
from support.made_run import (
    AT_HIT,
    AT_POINT,
    AT_POSTURE,
    HIT_EVENTS,
    after,
    finished,
    fresh,
    judged,
    prompted,
)
from support.stage import Stage, play

from armodal.daq.session_machine import PromptKind, skip
from armodal.tui.screens.run.help import HelpScreen
from armodal.tui.screens.run.views.progress import outcome_text


def test_only_a_durable_hit_is_called_accepted(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        assert "record" not in stage.text()
        await stage.tell(pilot, judged(1, "double"))
        assert "not accepted (record 1)" in stage.text()
        assert "touched twice" in stage.text()
        await stage.tell(pilot, judged(2))
        assert "✓ record 2 is in the journal" in stage.text()

    play(stage, body)


def all_done():
    session = AT_HIT
    while session.kind is not PromptKind.DONE:
        session = skip(session)
    return session


@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.long), (50, 12)])
@pytest.mark.parametrize(
    "asked_next",
    [
        AT_POINT,
        *(pytest.param(asked, marks=pytest.mark.long) for asked in (AT_POSTURE, AT_HIT)),
        all_done(),
    ],
)
def test_the_verdict_is_shown_whatever_is_asked_next(tmp_path, size, asked_next):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(1), prompted(asked_next))
        assert "record 1 is in the journal" in stage.text()

    play(stage, body, size)


@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.long), (50, 12)])
def test_the_end_of_a_session_is_told_with_its_last_verdict(tmp_path, size):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(1), prompted(all_done()), finished())
        assert "1 hits accepted, 0 not" in stage.text()
        assert "record 1 is in the journal" in stage.text()

    play(stage, body, size)


def test_a_verdict_takes_the_help_away(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await pilot.press("question_mark")
        await stage.settle(pilot)
        assert isinstance(stage.app.screen, HelpScreen)
        await stage.tell(pilot, judged(1))
        assert "record 1 is in the journal" in stage.text()

    play(stage, body)


def test_the_end_says_what_to_do_with_the_session(tmp_path):
    stage = Stage(tmp_path)
    stage.app.conductor.derive = lambda: asyncio.sleep(0)
    done = finished(accepted=9, rejected=1)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, prompted(AT_POSTURE), done)
        assert "9 hits accepted, 1 not" in stage.text()
        assert "q: leave" in stage.text()

    play(stage, body)


def test_a_session_that_ends_with_skipped_points_says_so_and_how_to_measure_them():
    state = after(fresh(), *HIT_EVENTS)
    ended = finished(complete=False, reason="1 of 40 planned points were skipped and lack hits")
    half = outcome_text(after(state, ended), 80).plain
    assert "r: go on at the same point" in half
    partly = outcome_text(after(state, prompted(all_done()), ended), 80).plain
    assert "r: measure what was skipped" in partly
    assert partly.splitlines()[0] != half.splitlines()[0]  # another large word
    whole = outcome_text(after(state, prompted(all_done()), finished()), 80).plain
    assert "r: " not in whole


def test_the_hit_that_finishes_a_posture_is_answered_on_the_posture_screen(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(5), prompted(AT_POSTURE))
        assert "✓ record 5 is in the journal" in stage.text()

    play(stage, body, (80, 24))
