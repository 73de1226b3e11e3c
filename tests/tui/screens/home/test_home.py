"""The home screen lists what is there and leaves with a wish."""

from __future__ import annotations

import asyncio
import os

import h5py
import numpy as np
import pytest
from support.screen import screen_rows
from textual.widgets import Button, Input, OptionList, Static

from armodal.protocols.session.hdf5 import DEFINITION, FORMAT_VERSION
from armodal.protocols.session.hdf5_tree import add_array, add_text
from armodal.tui.screens.home.app import HomeApp
from armodal.tui.screens.home.devices import Devices
from armodal.tui.screens.home.found_sessions import find_sessions, new_journal
from armodal.tui.screens.home.new_session import NewSession
from armodal.tui.screens.wishes import Demonstrate, Look, Measure, OwnArm


def write_session_head(path, *, complete):
    """What a session file says of itself, and no more."""
    path.parent.mkdir(exist_ok=True)
    with h5py.File(path, "w") as file:
        entry = file.create_group("session")
        add_text(entry, "definition", DEFINITION)
        add_array(entry, "format_version", np.array(FORMAT_VERSION, dtype=np.int64))
        add_array(entry, "complete", np.array(complete, dtype=np.uint8))


@pytest.fixture
def folder(tmp_path):
    write_session_head(tmp_path / "old.h5", complete=True)
    write_session_head(tmp_path / "demo" / "half.h5", complete=False)
    (tmp_path / "demo" / "half.journal").write_bytes(b"")
    (tmp_path / "begun.journal").write_bytes(b"")
    (tmp_path / "other.h5").write_bytes(b"no session")
    for age, name in enumerate(["begun.journal", "demo/half.h5", "old.h5", "other.h5"]):
        os.utime(tmp_path / name, (1e9 - age, 1e9 - age))
    return tmp_path


def wish_after(folder, *keys, measures=True, look=None):
    """What the app is left with after some keys."""

    async def go():
        app = HomeApp(folder, measures=measures, ports=lambda: [("/dev/ttyX", "A board")])
        async with app.run_test(size=(80, 24)) as pilot:
            await pilot.press(*keys)
            await pilot.pause()
            if look is not None:
                look(app)
        return app.return_value

    return asyncio.run(go())


def test_sessions_are_listed_newest_first_and_other_files_left_out(folder):
    found = find_sessions(folder)
    assert [one.path.relative_to(folder).as_posix() for one in found] == [
        "begun.journal",
        "demo/half.h5",
        "old.h5",
    ]
    assert [one.unfinished is not None for one in found] == [True, True, False]


def test_enter_looks_at_a_session_and_goes_on_with_a_journal(folder):
    assert wish_after(folder, "down", "down", "enter") == Look(session=folder / "old.h5")
    assert wish_after(folder, "enter") == Measure(
        journal=folder / "begun.journal", arm="", plan=None, simulated=False
    )


def test_r_goes_on_with_the_one_under_the_cursor(folder):
    wish = wish_after(folder, "down", "r")
    assert wish.journal == folder / "demo" / "half.journal"


def test_the_command_palette_lists_every_key_of_the_screen(folder):
    listed = []

    def look(app):
        listed.extend(command.title for command in app.get_system_commands(app.screen))

    wish_after(folder, look=look)
    wanted = {"New session", "Resume", "Demo", "Try it simulated", "Devices", "Own arm", "Leave"}
    assert wanted <= set(listed)
    assert len(listed) == len(set(listed))


def test_the_demo_is_one_key_away(folder):
    assert wish_after(folder, "d") == Demonstrate(folder=folder / "demo")


def test_a_new_session_is_begun_with_what_the_fields_say(folder):
    keys = ["s", "enter", "enter", "enter", *"shift two", "enter"]
    assert wish_after(folder, *keys) == Measure(
        journal=folder / "session.journal",
        arm="rv4frl",
        plan="rv4frl-three-postures",
        simulated=True,
        measured_by="shift two",
    )


def test_an_own_arm_is_made_of_a_description_that_is_there(folder):
    def look(app):

        rows = screen_rows(app)
        assert sum("no.urdf" in row for row in rows) == 2  # as it was typed, and what was wanted
        assert any("wanted a .urdf, .xacro, .xml file" in row for row in rows)

    assert wish_after(folder, "o", *"no.urdf", "enter", look=look) is None
    (folder / "my.urdf").write_text("<robot/>")
    wish = wish_after(folder, "o", *"my.urdf", "enter")
    assert wish == OwnArm(description=folder / "my.urdf", folder=folder)


def test_a_new_session_is_begun_with_the_arm_just_made(folder):
    made = folder / "my" / "my.toml"
    made.parent.mkdir()
    made.with_name("plan.toml").write_text("")

    async def go():
        app = HomeApp(folder, measures=True, ports=list, arm_made=made)
        async with app.run_test(size=(80, 24)) as pilot:
            await pilot.press("n")
            given = (app.screen.query_one(f"#{field}", Input).value for field in ("arm", "plan"))
            return tuple(given)

    assert asyncio.run(go()) == (str(made), str(made.with_name("plan.toml")))


@pytest.mark.parametrize(
    ("keys", "hint"),
    [
        pytest.param(["s"], "A shipped arm", marks=pytest.mark.long),
        (["s", "enter", "enter", "enter"], "the report"),
    ],
)
def test_the_whole_question_fits_80_by_24_and_tells_of_the_field_in_use(folder, keys, hint):
    def look(app):
        rows = "\n".join(screen_rows(app))
        for words in (
            "simulated laboratory",
            "Arm",
            "Plan",
            "Name",
            "Who measures",
            "Begin",
            "session ",
            hint,
        ):
            assert words in rows

    wish_after(folder, *keys, look=look)


def test_all_that_is_wrong_with_a_new_session_is_said_at_once(folder):
    async def go():
        app = HomeApp(folder, measures=True, ports=list)
        async with app.run_test(size=(80, 24)) as pilot:
            await pilot.press("n")
            app.screen.query_one("#arm", Input).value = "rv4frl"
            app.screen.query_one("#plan", Input).value = "nosuch"
            app.screen.query_one("#name", Input).value = "begun"
            app.screen.query_one("#begin", Button).press()
            await pilot.pause()
            assert isinstance(app.screen, NewSession)
            return str(app.screen.query_one("#wrong", Static).render())

    said = asyncio.run(go())
    assert "nosuch" in said
    assert "begun.journal is there already" in said


def test_devices_are_told_with_what_they_call_themselves(folder):
    def look(app):
        assert isinstance(app.screen, Devices)
        assert "/dev/ttyX  A board" in str(app.screen.query_one(Static).render())

    assert wish_after(folder, "v", look=look) is None


def test_where_no_device_runs_nothing_is_offered_that_measures(folder):
    def look(app):
        choices = app.query_one(OptionList)
        ids = [o.id for o in choices.options if o.id and not o.id.startswith("session")]
        assert ids == ["own", "leave"]

    assert wish_after(folder, "d", measures=False, look=look) is None


def test_a_name_for_a_new_session_is_of_nothing_that_is_there(tmp_path):
    assert new_journal(tmp_path).name == "session.journal"
    (tmp_path / "session.h5").write_bytes(b"")
    (tmp_path / "session-2.journal").write_bytes(b"")
    assert new_journal(tmp_path).name == "session-3.journal"
