"""The next test that Gap proposes: shown, written as a plan, and gone on with."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from rich.console import Console
from support.gap_results import made_result
from support.shown_results import GAP

from armodal.analyzer.gap.records import NextTest
from armodal.protocols.errors import ArmodalError, PlanError, SessionError
from armodal.protocols.plan import load_plan
from armodal.tui.command_parts import journey
from armodal.tui.command_parts.gap_results import gap_json
from armodal.tui.screens.review.gap_text import gap_view
from armodal.tui.screens.review.leaving import Leaving
from armodal.tui.screens.review.measuring import Measuring
from armodal.tui.screens.review.next_test import NextRun, next_run, next_test_plan
from armodal.tui.screens.wishes import Measure


def plain(renderable, width=100):
    console = Console(width=width, color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


def proposing(session):
    """A gap result that proposes to measure the session's plan once more."""
    test = {
        "words": "Hit point 7 along y.",
        "why": "It tells base rocking from the bearing.",
        "gain": 12.5,
        "plan_toml": session.header.plan.text,
    }
    return {**GAP, "next_test": test}


def test_the_next_test_is_shown_with_its_reason_and_its_key(session):
    shown = plain(gap_view(proposing(session)))
    for words in ("Hit point 7 along y.", "why: It tells", "n: write it as a plan"):
        assert words in shown
    assert "plan_toml" not in shown


def test_a_result_as_the_workflow_writes_it_shows_its_next_test(session):
    test = NextTest(words="Hit it.", why="to know", gain=3.0, plan_toml=session.header.plan.text)
    found = gap_json(replace(made_result("ambiguous", ()), next_test=test), {})
    assert "Next test: Hit it." in plain(gap_view(found))
    assert next_test_plan(session, found) == session.header.plan.text
    assert "Next test" not in plain(gap_view(gap_json(made_result("ambiguous", ()), {})))


@pytest.mark.parametrize("test", [None, "words", {}, {"plan_toml": "name = 1"}])
def test_a_next_test_without_a_plan_for_the_arm_is_refused(session, test):
    with pytest.raises(PlanError):
        next_test_plan(session, {"next_test": test})
    with pytest.raises(PlanError):
        next_test_plan(session, None)


@pytest.fixture
def drive_proposing(drive, session):
    """Runs steps on the app with a gap result that proposes a test."""
    kept = json.dumps(proposing(session))

    def run(steps):
        return drive(steps, prepare=lambda path: path.with_suffix(".gap.json").write_text(kept))

    return run


def test_one_key_writes_the_plan_and_never_over_another(drive_proposing, session):
    async def steps(app, pilot):
        await pilot.press("8", "n")
        await pilot.pause()
        pane = app.query_one("#gap-main")
        written = load_plan(pane.plan_path(), session.header.arm)
        assert written.text == session.header.plan.text
        await pilot.press("escape")
        pane.plan_path().write_text("mine")
        await pilot.press("n")
        await pilot.pause()
        assert pane.plan_path().read_text() == "mine"
        assert not isinstance(app.screen, Measuring)

    drive_proposing(steps)


@pytest.mark.parametrize("key", ["n", pytest.param("enter", marks=pytest.mark.long)])
def test_the_same_key_once_more_leaves_to_measure_the_plan(drive_proposing, session, key):
    async def steps(app, pilot):
        await pilot.press("8", "n")
        await pilot.pause()
        assert isinstance(app.screen, Measuring)
        await pilot.press(key)
        await pilot.pause()

    app = drive_proposing(steps)
    assert app.return_code == 0
    assert app.next_run.plan == app.path.with_name("s-next-test.toml")
    assert app.next_run.journal == app.path.with_name("s-next-test.journal")
    assert app.next_run.arm.sha256 == session.header.arm.sha256
    assert app.next_run.simulated


def test_escape_stays_in_review_and_the_key_asks_again_for_the_plan_that_is_there(drive_proposing):
    async def steps(app, pilot):
        for _ in range(2):
            await pilot.press("8", "n")
            await pilot.pause()
            assert isinstance(app.screen, Measuring)
            await pilot.press("escape")
            await pilot.pause()
            assert app.is_running
            assert app.next_run is None

    drive_proposing(steps)


def test_picks_not_saved_are_asked_about_before_the_next_test(drive_proposing):
    async def steps(app, pilot):
        app.state.unsaved = True
        await pilot.press("8", "n")
        await pilot.pause()
        await pilot.press("n")
        await pilot.pause()
        assert isinstance(app.screen, Leaving)
        await pilot.press("escape")
        await pilot.pause()
        assert app.next_run is None

    drive_proposing(steps)


def test_a_session_of_a_real_board_is_followed_by_one_with_real_ports(session, tmp_path):
    real = replace(session.header.dictionary, board_id="board-7")
    header = replace(session.header, dictionary=real)
    assert not next_run(replace(session, header=header), tmp_path / "p.toml").simulated


@dataclass
class LeftApp:
    """A review app that has been left."""

    next_run: NextRun | None
    problem: ArmodalError | None = None
    return_code: int = 0
    path: Path = Path("s.h5")


def test_the_plan_is_measured_after_the_review_has_been_left(session, tmp_path):
    wanted = next_run(session, tmp_path / "p.toml")
    assert journey.wish_after_review(LeftApp(wanted)) == (
        0,
        Measure(
            journal=tmp_path / "p.journal",
            arm=wanted.arm,
            plan=str(tmp_path / "p.toml"),
            simulated=True,
            earlier=Path("s.h5"),
        ),
    )


def test_nothing_follows_a_review_left_without_a_wish_or_with_a_problem(monkeypatch):
    said = []
    monkeypatch.setattr(journey, "say_next", said.append)
    assert journey.wish_after_review(LeftApp(None)) == (0, None)
    assert said == ["report s.h5"]
    with pytest.raises(SessionError):
        journey.wish_after_review(LeftApp(None, SessionError("no")))


def test_without_a_proposed_test_the_key_says_so_and_writes_nothing(drive, notices):
    async def steps(app, pilot):
        await pilot.press("8", "n")
        await pilot.pause()
        assert any("proposes none" in told for told in notices)
        assert not app.query_one("#gap-main").plan_path().exists()

    drive(steps, prepare=lambda path: path.with_suffix(".gap.json").write_text(json.dumps(GAP)))
