"""The screens by their state and by what can be read on them."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest
from support.screen import screen_rows, screen_text
from support.shipped_screens import SHIPPED_PANES as SHIPPED

from armodal.analyzer.arm.superset import Superset
from armodal.protocols.errors import EstimateError, SessionError
from armodal.protocols.session.records import Session
from armodal.tui.screens.key_line import KeyLine
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.posture_view import (
    PostureView,
    fit_automatic,
    open_session,
    opened_session,
)
from armodal.tui.screens.themes import MONO

SIZES = [(80, 24), pytest.param((160, 45), marks=pytest.mark.long)]

WORDS = {
    "frf": ("accelerance", "coherence", "hit 1", "Hz"),
    "cmif": ("CMIF", "singular value"),
    "poles": ("order", "picked", "damping"),
    "modes": ("f Hz", "± std", "joints %", "structural"),
    "mac": ("MAC of test 1", "1.00"),
    "shape": ("mode 1/", "amplitude"),
    "identify": ("enter: identify",),
    "gap": ("gap",),
}


@pytest.mark.parametrize("size", SIZES)
def test_every_screen_shows_its_key_words_and_how_to_leave_at_the_smallest_and_at_a_large_size(
    drive, size
):
    async def steps(app, pilot):
        for number, tab in enumerate(WORDS, start=1):
            await pilot.press(str(number))
            await pilot.pause()
            shown = screen_text(app)
            assert [word for word in WORDS[tab] if word not in shown] == []
            assert "posture 1/4 test 1" in shown
            assert "lost 0" in shown
            assert screen_rows(app)[-1].endswith("? help q leave")

    drive(steps, size=size)


def test_brackets_go_through_the_postures_and_round_the_end(drive):
    async def steps(app, pilot):
        await pilot.press("right_square_bracket")
        assert app.state.view.name == "test 2"
        await pilot.press("left_square_bracket", "left_square_bracket")
        assert app.state.posture == len(app.state.views) - 1

    drive(steps)


def test_a_mode_chosen_in_the_table_is_the_one_that_moves(drive):
    async def steps(app, pilot):
        await pilot.press("4", "down", "down")
        assert app.state.mode == 2
        await pilot.press("enter")
        await pilot.pause()
        assert "mode 3/" in screen_text(app)

    drive(steps)


def test_keys_turn_zoom_amplify_slow_and_name_the_moving_arm(drive, clock):
    async def steps(app, pilot):
        await pilot.press("6")
        await pilot.pause()
        shape = app.query_one("#shape-main")
        first = shape.camera
        await pilot.press("right", "up", "plus", "greater_than_sign", "d", "l")
        assert shape.camera.azimuth_rad != first.azimuth_rad
        assert shape.camera.elevation_rad > first.elevation_rad
        assert shape.camera.zoom > first.zoom
        assert shape.amplification > 1.0 > shape.speed
        await pilot.pause()
        assert "•18" in screen_text(app)
        await pilot.press("space")
        phase = shape.phase_rad
        clock.now += 0.3
        shape.tick()
        assert shape.phase_rad == phase

    drive(steps, size=(160, 45))


def test_the_phase_follows_the_clock_not_the_number_of_pictures(drive, clock):
    async def steps(app, pilot):
        await pilot.press("6")
        shape = app.query_one("#shape-main")
        await pilot.pause()
        shape.tick()
        phase = shape.phase_rad
        clock.now += 0.4  # a quarter of the cycle of 1.6 s
        shape.tick()
        assert (shape.phase_rad - phase) % (2 * np.pi) == pytest.approx(np.pi / 2)

    drive(steps)


def test_a_structural_mode_has_its_axis_drawn(drive):
    async def steps(app, pilot):
        view = app.state.view
        structural = [i for i in range(app.state.n_modes) if view.structural(i)]
        app.state.choose_mode(structural[0])
        await pilot.press("6")
        await pilot.pause()
        assert "Mozzi axis" in screen_text(app)

    drive(steps, size=(160, 45))


def test_a_mode_is_seen_from_where_it_moves_most_until_the_view_is_turned_by_hand(drive):
    async def steps(app, pilot):
        await pilot.press("6")
        await pilot.pause()
        shape = app.query_one("#shape-main")
        views = []
        for _ in range(app.state.n_modes):
            views.append(shape.camera)
            await pilot.press("n")
            await pilot.pause()
        assert len({view.azimuth_rad for view in views}) > 1
        await pilot.press("left", "n")
        await pilot.pause()
        turned = shape.camera
        await pilot.press("n")
        await pilot.pause()
        assert shape.camera is turned
        await pilot.press("0")
        await pilot.pause()
        assert shape.camera.azimuth_rad != turned.azimuth_rad

    drive(steps)


@pytest.mark.parametrize("columns", [80, pytest.param(160, marks=pytest.mark.long)])
def test_the_table_of_modes_leaves_columns_out_by_importance_and_says_which(drive, columns):
    async def steps(app, pilot):
        await pilot.press("4")
        await pilot.pause(0.2)
        text = screen_text(app)
        table = app.query_one("#modes-main")
        assert table.virtual_size.width <= columns  # nothing to be scrolled to
        assert all(name in text for name in ("f Hz", "damp %", "joints %", "kind"))
        assert ("in a wider window: MPD °" in text) is (columns == 80)

    drive(steps, size=(columns, 24))


@pytest.mark.long
def test_no_color_uses_the_theme_without_colour(drive):
    async def steps(app, pilot):
        assert app.theme == MONO

    drive(steps, environment={"NO_COLOR": "1"})


def test_a_window_too_small_says_so_and_comes_back(drive):
    async def steps(app, pilot):
        await pilot.resize_terminal(40, 10)
        await pilot.pause()
        assert "too small" in screen_text(app)
        await pilot.resize_terminal(90, 30)
        await pilot.pause()
        assert "too small" not in screen_text(app)
        assert "1 FRF" in screen_text(app)

    drive(steps)


def test_help_on_the_screen_in_use_comes_and_goes(drive):
    async def steps(app, pilot):
        await pilot.press("3", "question_mark")
        await pilot.pause()
        assert "Stabilisation" in screen_text(app)
        await pilot.press("question_mark")
        await pilot.pause()
        assert not app.screen.query("HelpPanel")

    drive(steps, size=(160, 45))


def _opened_changed(opened, arm, joints_rad):
    header = replace(opened.session.header, arm=arm)
    frf = replace(opened.views[0].frf, joints_rad=joints_rad)
    superset = Superset(arm)
    view = fit_automatic(superset, PostureView(frf=frf))
    session = replace(opened.session, header=header)
    return replace(opened, session=session, superset=superset, views=(view,))


def _every_screen(opened, path):
    async def main():
        shown = {}
        app = ReviewApp(path, opened=replace(opened, path=path), environment={}, panes=SHIPPED)
        async with app.run_test(size=(100, 30)) as pilot:
            await app.workers.wait_for_complete()
            for number, tab in enumerate(WORDS, start=1):
                await pilot.press(str(number))
                await pilot.pause()
                shown[tab] = screen_text(app)
        return shown

    return asyncio.run(main())


def test_a_structure_without_an_arm_is_shown_by_its_points(opened, tmp_path):
    arm = opened.session.header.arm
    points = tuple(replace(point, link="base") for point in arm.points)
    bare = replace(arm, joints=(), points=points)
    shown = _every_screen(_opened_changed(opened, bare, np.zeros(0)), tmp_path / "s.h5")
    assert "unknown" in shown["modes"]
    assert "mode 1/" in shown["shape"]
    assert "•" in shown["shape"]


def test_a_posture_without_joint_angles_says_why_no_arm_is_drawn(opened, tmp_path):
    arm = opened.session.header.arm
    shown = _every_screen(_opened_changed(opened, arm, None), tmp_path / "s.h5")
    assert "no joint angles were measured" in shown["shape"]


@pytest.mark.long
def test_a_wall_screen_is_filled(drive):
    async def steps(app, pilot):
        for key in "123":
            await pilot.press(key)
            await pilot.pause()
            assert screen_rows(app)[80]

    drive(steps, size=(320, 90))


@pytest.mark.parametrize("has_journal", [True, False])
def test_an_unreadable_session_is_said_with_the_way_back_if_there_is_one(tmp_path, has_journal):
    path = tmp_path / "broken.h5"
    path.write_bytes(b"not a session")
    if has_journal:
        path.with_suffix(".journal").write_bytes(b"")

    async def main():
        app = ReviewApp(path, environment={})
        async with app.run_test(size=(80, 24)) as pilot:
            await app.workers.wait_for_complete()
            await pilot.pause()
            shown = screen_text(app)
            assert "cannot be shown" in shown
            assert ("armodal recover broken.journal" in shown) == has_journal
            await pilot.press("q")
        return app

    app = asyncio.run(main())
    assert app.problem is not None


def test_a_session_without_accepted_hits_is_refused_with_what_to_do(session, tmp_path):
    empty = Session(header=session.header, hits=(), losses=(), complete=False)
    with pytest.raises(SessionError, match="armodal run"):
        opened_session(tmp_path / "s.h5", empty)


def test_a_band_asked_for_is_all_that_is_looked_at(session, tmp_path):
    opened = opened_session(tmp_path / "s.h5", session, band_hz=(10.0, 60.0))
    assert opened.band_hz == (10.0, 60.0)
    for view in opened.views:
        assert 10.0 <= view.frf.freq_hz[0] < 11.0
        assert 59.0 < view.frf.freq_hz[-1] <= 60.0
    with pytest.raises(EstimateError, match=r"the band 10 to 12 Hz holds .* widen it"):
        opened_session(tmp_path / "s.h5", session, band_hz=(10.0, 12.0))


def test_a_file_that_is_not_there_is_a_session_error(tmp_path):
    with pytest.raises(SessionError):
        open_session(tmp_path / "none.h5")


KEYS = {
    "frf": "+/- zoom n mode ↑↓ FRF a all p phase y curve [] posture w report ? help q leave",
    "cmif": "+/- zoom n mode g groups [] posture w report ? help q leave",
    "poles": "+/- zoom n mode space pick x drop r refit a auto s save [] posture w report ? help "
    "q leave",
    "modes": "⏎ shape s save picks [] posture w report ? help q leave",
    "mac": "c compare with [] posture w report ? help q leave",
    "shape": "n mode ←↑ turn +/- zoom </> amplitude f/d speed space stop l names [] posture w "
    "report ? help q leave",
    "identify": "⏎ start esc stop [] posture w report ? help q leave",
    "gap": "⏎ start esc stop n next test → run [] posture w report ? help q leave",
}


def test_each_screen_says_on_its_last_row_what_the_keys_do(drive):
    async def steps(app, pilot):
        for number, tab in enumerate(WORDS, start=1):
            await pilot.press(str(number))
            await pilot.pause()
            assert screen_rows(app)[-1] == KEYS[tab]

    drive(steps, size=(160, 45))


def test_the_key_line_follows_the_screen_in_use_and_takes_clicks(drive):
    async def steps(app, pilot):
        line = app.query_one(KeyLine)
        await pilot.press("8")
        await pilot.pause()
        assert "next test" in line.render().plain
        widgets = len(app.screen.query("*"))
        await pilot.press("6")
        await pilot.pause()
        assert "next test" not in line.render().plain
        assert len(app.screen.query("*")) == widgets
        await pilot.click(KeyLine, offset=(line.render().plain.index("posture"), 0))
        await pilot.pause()
        assert app.state.posture == len(app.state.views) - 1  # `[`, the first of the two keys

    drive(steps, size=(160, 45))
