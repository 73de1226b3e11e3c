"""A key that does nothing is answered by the keys that do."""

from __future__ import annotations

import asyncio

from support.made_run import HIT_EVENTS, LAB_EVENTS
from support.stage import Stage, play

from armodal.tui.screens.home.app import HomeApp


def test_a_key_that_does_nothing_is_answered_once_by_those_that_do(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await pilot.press("x", "x", "5")
        assert stage.notices == [
            "x does nothing here. These keys do: t Retake, k Skip, g Grid, b Bell, ? Help, q Leave."
        ]

    play(stage, body)


def test_a_key_that_does_nothing_now_is_answered_too(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await pilot.press("u")  # there is no accepted hit to take back
        assert stage.notices[0].startswith("u does nothing here. These keys do: t Retake")

    play(stage, body)


def test_keys_that_do_something_or_belong_to_a_dialogue_are_not_answered(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS)
        await pilot.press("1")  # a port of the list
        await pilot.press("c")  # asks for the mass
        await pilot.pause()
        await pilot.press("x", "escape")
        await stage.tell(pilot, *HIT_EVENTS[len(LAB_EVENTS) :])
        await pilot.press("g", "right", "g", "question_mark", "space")
        assert not any("does nothing" in words for words in stage.notices)

    play(stage, body)


def test_the_home_screen_answers_too(tmp_path):
    said: list[str] = []

    async def run() -> None:
        app = HomeApp(tmp_path, measures=True, ports=list)
        async with app.run_test(message_hook=lambda m: said.append(str(vars(m)))) as pilot:
            await pilot.press("down", "x")
            await pilot.pause()

    asyncio.run(run())
    assert any("x does nothing here" in words and "n new session" in words for words in said)
