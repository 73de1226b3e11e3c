"""The screens with injected events and clock, at the sizes people have."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.made_run import (
    ARM,
    AT_HIT,
    AT_POINT,
    HIT_EVENTS,
    LAB_EVENTS,
    SESSION_EVENTS,
    after,
    fresh,
    judged,
    prompted,
    reading,
    trial,
)
from support.screen import screen_rows, screen_text
from support.stage import Stage, play

from armodal.daq.events import Failed, LossNoted
from armodal.daq.session_machine import hit_judged
from armodal.protocols.session.records import Loss
from armodal.tui.screens.key_line import KeyLine
from armodal.tui.screens.run.happenings import (
    SafeConfirmed,
    SensorsConfirmed,
)
from armodal.tui.screens.run.step_screen import Pane
from armodal.tui.screens.run.steps.progress import ProgressScreen
from armodal.tui.screens.run.views.parts import losses_text
from armodal.tui.screens.run.views.posture import joints_text

SIZES = [(80, 24), *(pytest.param(s, marks=pytest.mark.long) for s in ((160, 45), (250, 70)))]


@pytest.mark.parametrize("size", SIZES)
def test_every_screen_fits_every_size(tmp_path, size):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS, *[trial()] * 4)
        assert "board-7" in stage.text()
        assert "suggested 10 N" in stage.text()
        await stage.tell(pilot, *SESSION_EVENTS[len(LAB_EVENTS) :])
        assert "joint_6" in stage.text()
        await stage.tell(pilot, prompted(AT_POINT), SafeConfirmed())
        assert "Mount the sensor at point 1" in stage.text()
        assert "◉ 1" in stage.text()
        await stage.tell(pilot, prompted(AT_HIT))
        assert "Hit point 1" in stage.text()
        await stage.tell(pilot, judged(1), prompted(hit_judged(AT_HIT, accepted=True)))
        assert "record 1 is in the journal" in stage.text()
        assert "FRF of point 1" in stage.text()
        for pane in stage.app.screen.query(Pane):
            assert pane.region.right <= size[0]
            assert pane.region.bottom <= size[1]
        await pilot.press("g")
        await stage.settle(pilot)
        assert "◐1/3" in stage.text()

    play(stage, body, size)


@pytest.mark.long
def test_a_click_on_a_key_of_the_footer_presses_it(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        line = stage.app.screen.query_one(KeyLine)
        await pilot.click(KeyLine, offset=(line.render().plain.index("Grid"), 0))
        await stage.settle(pilot)
        assert isinstance(stage.app.screen, ProgressScreen)

    play(stage, body)


def test_unknown_angles_are_shown_as_unknown(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS, reading(None))
        assert stage.text().count("? unknown") == len(ARM.joints)
        assert "POSTURE UNKNOWN - stay away" in stage.text()

    play(stage, body)


def test_a_tiny_window_says_so_and_still_shows_the_verdict(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(1))
        assert "window is too small" in stage.text()
        assert "record 1 is in the journal" in stage.text()

    play(stage, body, (50, 12))


def test_a_resize_in_the_middle_of_a_hit_loses_nothing(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await pilot.resize_terminal(40, 10)
        await stage.tell(pilot, judged(1))
        await pilot.resize_terminal(160, 45)
        await stage.settle(pilot)
        assert "record 1 is in the journal" in stage.text()
        assert "window is too small" not in stage.text()

    play(stage, body)


@pytest.mark.parametrize(
    ("kind", "message", "words"),
    [
        ("JournalError", "cannot write the journal: no space is left on the disk", "disk is full"),
        pytest.param(
            "DeviceLostError",
            "the board on /dev/ttyACM0 is gone",
            "Plug it in again",
            marks=pytest.mark.long,
        ),
        pytest.param(
            "CanError",
            "no frame came on /dev/ttyACM1",
            "controller is silent",
            marks=pytest.mark.long,
        ),
        ("SomethingElse", "what nobody has thought of", "cannot go on"),
    ],
)
def test_a_failure_is_told_in_the_operators_words_with_the_way_back(tmp_path, kind, message, words):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(
            pilot, *HIT_EVENTS, judged(1), Failed(message=message, kind=kind, journal="s.journal")
        )
        text = stage.text()
        assert words in text
        assert message in text
        assert "Every accepted hit is safe in s.journal" in text
        assert "r: try again and go on at the same point" in text

    play(stage, body, (80, 24))


def test_losses_are_in_sight_on_every_screen(tmp_path):
    stage = Stage(tmp_path)
    lost = LossNoted(loss=Loss(kind="stream", count=7, first_sample=None, host_s=0.0, note=""))

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS)
        assert "lost: nothing" in stage.text()
        await stage.tell(pilot, lost)
        for events in (
            (SensorsConfirmed(),),
            SESSION_EVENTS[len(LAB_EVENTS) :],
            (prompted(AT_POINT), SafeConfirmed()),
            (prompted(AT_HIT),),
        ):
            await stage.tell(pilot, *events)
            assert "! lost: stream 7" in stage.text()

    play(stage, body, (80, 24))


def test_without_colour_every_state_is_still_told_apart(tmp_path, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(1))
        # The monochrome filter of Textual is on, and the marks do not need it off.
        assert stage.app.no_color
        assert "✓ record 1" in stage.text()
        await stage.tell(pilot, judged(2, "soft"))
        assert "✗ not accepted" in stage.text()

    play(stage, body)


def test_help_names_every_key_and_goes(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await pilot.press("question_mark")
        await pilot.pause()
        assert type(stage.app.screen).__name__ == "HelpScreen"
        text = screen_text(stage.app)
        for binding in stage.app.BINDINGS:
            assert binding.tooltip is None or binding.tooltip in text
        assert "Any key closes this help" in text
        await pilot.press("space")
        await pilot.pause()
        assert type(stage.app.screen).__name__ == "LabScreen"

    play(stage, body, (80, 24))


def test_the_grid_says_first_what_is_left_and_keeps_the_chosen_point_in_sight(tmp_path):
    stage = Stage(tmp_path)

    def rows() -> list[str]:
        return screen_rows(stage.app)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await pilot.press("g")
        await stage.settle(pilot)
        assert "198 hits left" in rows()[1]
        assert "Enter: go there" in rows()[1]
        await pilot.press("left")  # round the end: the last point of all
        await stage.settle(pilot)
        assert any("validation 2" in row for row in rows())
        assert not any("hits left, " in row for row in rows()[1:])
        await pilot.press("right")
        await pilot.press("pageup")
        await stage.settle(pilot)
        assert any("test 1  0 of 18" in row for row in rows())

    play(stage, body, (80, 20))


def test_a_screen_whose_panes_are_being_taken_away_is_left_alone(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        await stage.app.screen.query_one("#safety").remove()
        await stage.tell(pilot, judged(1))  # nothing is raised
        assert stage.app.state.last_hit is not None

    play(stage, body)


@pytest.mark.parametrize("told_meanwhile", [True, False])
def test_an_app_that_waited_for_its_turn_hears_what_was_said_before_it_calls_it_old(
    tmp_path, told_meanwhile
):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        stage.unheard += [reading()] if told_meanwhile else []
        stage.now_s += 5.0
        stage.app.conductor.tick()
        assert stage.app.state.safe is told_meanwhile

    play(stage, body)


@pytest.mark.parametrize("columns", [60, pytest.param(80, marks=pytest.mark.long)])
def test_the_safety_line_is_whole_and_that_nothing_was_lost_gives_way(tmp_path, columns):
    stage = Stage(tmp_path)
    lost = LossNoted(loss=Loss(kind="stream", count=7, first_sample=None, host_s=0.0, note=""))

    async def body(pilot):
        await stage.tell(pilot, *SESSION_EVENTS, reading(None))
        safety = "✗ POSTURE UNKNOWN - stay away from the arm"
        line = screen_rows(stage.app)[-2]
        assert line.startswith(f" {safety}")
        assert ("lost: nothing" in line) is (columns > len(safety) + len("lost: nothing") + 4)
        await stage.tell(pilot, lost)
        line = screen_rows(stage.app)[-2]
        assert line.startswith(f" {safety}")
        assert "! lost" in line

    play(stage, body, (columns, 24))


def test_long_names_of_joints_are_told_apart(tmp_path):
    parts = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    names = [f"{part}_joint" for part in parts]
    arm = replace(
        ARM, joints=tuple(replace(j, name=n) for j, n in zip(ARM.joints, names, strict=True))
    )
    state = replace(after(fresh(), *SESSION_EVENTS), arm=arm)
    text = joints_text(state, 78, 20).plain
    assert all(f"{part} " in text for part in parts)


def test_frf_and_coherence_share_an_axis_of_frequency_from_the_first_hit_on(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS, judged(1))
        await stage.tell(pilot, prompted(hit_judged(AT_HIT, accepted=True)))
        await stage.settle(pilot)
        rows = stage.app.screen.query_one("#frf", Pane).plain.split("\n")
        assert any("coherence: needs a second hit" in row for row in rows)
        edges = {row.index(mark) for row in rows for mark in "│┤" if mark in row}
        assert len(edges) == 1
        assert rows[-1].split()[-1] == "Hz"

    play(stage, body, (80, 24))


def test_losses_of_a_simulator_that_runs_fast_are_told_as_its_own():
    lost = LossNoted(loss=Loss(kind="can", count=3, first_sample=None, host_s=0.0, note=""))
    state = replace(after(fresh(), *SESSION_EVENTS, lost), simulated=True)
    assert losses_text(state, 80).plain == "! lost: can 3"
    fast = replace(state, time_scale=8.0)
    assert losses_text(fast, 80).plain.endswith("(by the simulator, 8 times as fast as real time)")
