"""The stabilisation diagram in the review: poles picked by hand, cursor, zoom, groups."""

import json
from dataclasses import replace

import pytest
from support.screen import screen_text

from armodal.tui.screens.review.picked_file import picked_path


def test_a_pole_is_picked_by_hand_refitted_saved_and_found_again(drive, session, tmp_path):
    async def pick(app, pilot):
        before = app.state.n_modes
        await pilot.press("3", "c")
        assert app.state.view.picks == ()
        assert app.state.n_modes == before  # nothing is refitted unasked
        await pilot.press("space", "s")
        assert not picked_path(app.path).exists()  # not saved before the refit
        await pilot.press("r")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert app.state.view.by_hand
        assert app.state.n_modes == 1
        assert app.state.unsaved
        await pilot.press("s")
        assert not app.state.unsaved

    app = drive(pick)
    kept = json.loads(picked_path(app.path).read_text())
    f_hz = app.state.view.model.f_hz[0]
    assert kept["postures"]["test 1"][0]["f_hz"] == pytest.approx(f_hz)

    async def look(app, pilot):
        assert app.state.view.by_hand
        # The same least-squares problem from its own answer: its tolerance, 1e-5 half bandwidths.
        assert app.state.view.model.f_hz[0] == pytest.approx(f_hz, rel=1e-5)

    drive(look)


def test_the_pick_nearest_to_the_cursor_is_dropped_by_x(drive):
    async def steps(app, pilot):
        await pilot.press("3")
        picture = app.query_one("#poles-main")
        before = app.state.view.picks
        nearest = min(before, key=lambda pick: abs(abs(pick) - abs(picture.current())))
        await pilot.press("x")
        assert set(before) - set(app.state.view.picks) == {nearest}
        assert app.state.view.changed

    drive(steps)


def test_leaving_with_picks_not_saved_asks_first(drive):
    async def steps(app, pilot):
        await pilot.press("3", "c", "space", "r")
        await app.workers.wait_for_complete()
        await pilot.pause()
        await pilot.press("q")
        assert "not saved" in screen_text(app)
        await pilot.press("escape")
        assert app.return_code is None
        await pilot.press("q", "q")

    app = drive(steps)
    assert app.return_code == 0
    assert not picked_path(app.path).exists()


def test_picks_of_another_session_are_refused_and_said(drive, notices):
    def prepare(path):
        picked_path(path).write_text(
            json.dumps({"format": "armodal-picked-poles-1", "session_id": "f" * 32, "postures": {}})
        )

    async def steps(app, pilot):
        assert any("belongs to session" in told for told in notices)
        assert not app.state.view.by_hand

    drive(steps, prepare=prepare, size=(160, 45))


def test_a_click_on_a_pole_goes_there(drive):
    async def steps(app, pilot):
        await pilot.press("3")
        await pilot.pause()
        picture = app.query_one("#poles-main")
        await pilot.press("n")
        await pilot.pause()
        was = picture.pole
        table = app.state.view.automatic.stabilisation
        at = picture.frame.pixels([table.f_hz[was]], [float(table.order[was])])[0]
        await pilot.press("b")
        await pilot.click("#poles-main", offset=(int(at[0] // 2), int(at[1] // 4)))
        clicked = table.f_hz[picture.pole]
        cell_hz = picture.x_scale().high / picture.frame.columns
        assert abs(clicked - table.f_hz[was]) <= cell_hz

    drive(steps, size=(160, 45))


def test_keys_move_the_cursor_and_zoom_about_it(drive):
    async def steps(app, pilot):
        picture = app.query_one("#frf-main")
        await pilot.press("right")
        line, whole = picture.cursor_line(), picture.x_scale()
        await pilot.press("shift+right", "left")
        assert picture.cursor_line() == line + 9
        about_hz = picture.cursor_hz
        await pilot.press("plus", "plus", "plus", "plus")
        near = picture.x_scale()
        assert near.high - near.low < whole.high - whole.low
        assert near.holds(about_hz)
        await pilot.press(*["shift+right"] * 12)  # the window goes with the cursor
        assert picture.x_scale().holds(picture.cursor_hz)
        assert not picture.x_scale().holds(about_hz)
        await pilot.press("0")
        assert picture.x_scale().high == picture.freq_hz[-1]
        await pilot.press("n")
        assert app.state.mode == 1

    drive(steps)


def test_g_shows_sums_of_groups_of_points_and_again_the_singular_values(drive):
    async def steps(app, pilot):
        await pilot.press("2", "g")
        await pilot.pause()
        assert "sums of" in screen_text(app)
        await pilot.press("g")
        await pilot.pause()
        assert "singular value" in screen_text(app)

    drive(steps)


def test_arrows_go_to_the_next_pole_of_an_order_and_to_the_next_order(drive):
    async def steps(app, pilot):
        await pilot.press("3")
        await pilot.pause()
        picture = app.query_one("#poles-main")
        table = app.state.view.automatic.stabilisation
        was = picture.pole
        await pilot.press("down")
        lower = picture.pole
        assert table.order[lower] < table.order[was]
        await pilot.press("right")
        assert table.order[picture.pole] == table.order[lower]
        assert table.f_hz[picture.pole] > table.f_hz[lower]
        await pilot.press("left")
        assert picture.pole == lower
        await pilot.press("up")
        assert table.order[picture.pole] == table.order[was]

    drive(steps)


def test_the_automatic_choice_comes_back_without_another_fit(drive, monkeypatch):
    def fit(*_):
        pytest.fail("what is known was fitted again")

    async def steps(app, pilot):
        automatic = app.state.view.automatic
        app.state.views[0] = replace(app.state.view, picks=(), changed=True, by_hand=True)
        monkeypatch.setattr("armodal.tui.screens.review.posture_view.fit_modes", fit)
        await pilot.press("3", "a")
        await pilot.pause()
        view = app.state.view
        assert view.picks == tuple(mode.pole_rad_s for mode in automatic.modes)
        assert not view.changed
        assert not view.by_hand
        assert view.model is automatic

    drive(steps)
