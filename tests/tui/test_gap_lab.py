"""The closed loop: what could hide is asked for, measured, and the ranges shrink."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

import armodal.tui.gap_commands
import armodal.tui.gap_lab
from armodal.analyzer.gap.hit_levels import has_levels
from armodal.analyzer.gap.records import NextTest, Verdict
from armodal.hil_sim.study import make_case
from armodal.protocols.errors import SessionError
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.cli import app
from armodal.tui.gap_lab import SimulatedLaboratory, run_loop


@pytest.fixture(scope="module")
def case():
    return make_case(seed=8, arm="ur5")


@pytest.fixture(scope="module")
def loop(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("loop")
    return folder, run_loop(SimulatedLaboratory(case=case), folder, budget=1, gates=False)


def test_the_test_it_asked_for_is_run_and_told_with_its_reason(loop):
    folder, found = loop
    (test,) = found.tests
    assert test["number"] == 2
    assert "widens k of" in test["why"]
    assert test["gain"] > 0
    plan = read_session(folder / "test-2.h5").header.plan
    assert len(plan.postures) == 1
    names = [row.posture for row in found.outcome.result.gap_after]
    assert any(name.startswith("next test (test 2)") for name in names)


def test_no_stiffness_range_grows_by_far_and_all_hold_the_truth(loop, case):
    _, found = loop
    truth = json.loads(case.open_truth())["joints"]
    for row in found.outcome.result.joint_stiffness_ranges:
        assert row.low < truth[row.joint]["stiffness_n_m_per_rad"] < row.high
    assert found.outcome.result.verdict is Verdict.NOTHING_DETECTABLE


def canned(advice):
    return SimpleNamespace(
        result=SimpleNamespace(verdict=Verdict.AMBIGUOUS, next_test=advice), name="outcome"
    )


class Counting:
    """A laboratory that counts what it is asked."""

    def __init__(self, folder):
        self.session = read_session(folder / "test-1.h5")
        self.further = read_session(folder / "test-2.h5")
        self.arm = self.session.header.arm
        self.identity = "the only one"
        self.numbers = []

    def measure(self, plan, number):
        self.numbers.append(number)
        if plan is None:
            return self.session
        return replace(self.further, header=replace(self.further.header, plan=plan))


def test_a_loop_that_was_stopped_measures_nothing_twice(loop, tmp_path, monkeypatch):
    folder, _ = loop
    text = read_session(folder / "test-2.h5").header.plan.text
    advice = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text)
    monkeypatch.setattr(armodal.tui.gap_lab, "find_gap", lambda *_, **__: canned(advice))
    lab = Counting(folder)
    run_loop(lab, tmp_path / "new", budget=0)
    assert lab.numbers == [1]
    again = run_loop(lab, tmp_path / "new", budget=1)
    assert lab.numbers == [1, 2]
    assert [test["number"] for test in again.tests] == [2]
    run_loop(lab, tmp_path / "new", budget=1)
    assert lab.numbers == [1, 2]


def test_a_folder_of_another_test_is_refused(loop, tmp_path, monkeypatch):
    folder, _ = loop
    text = read_session(folder / "test-2.h5").header.plan.text
    lab = Counting(folder)
    first = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text)
    monkeypatch.setattr(armodal.tui.gap_lab, "find_gap", lambda *_, **__: canned(first))
    run_loop(lab, tmp_path, budget=1)
    other = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text + "\n# changed\n")
    monkeypatch.setattr(armodal.tui.gap_lab, "find_gap", lambda *_, **__: canned(other))
    with pytest.raises(SessionError, match="measured by another plan"):
        run_loop(lab, tmp_path, budget=1)


def test_a_folder_of_another_laboratory_is_refused_before_anything_is_measured(
    loop, tmp_path, monkeypatch
):
    folder, _ = loop
    monkeypatch.setattr(armodal.tui.gap_lab, "find_gap", lambda *_, **__: canned(None))
    one, other = Counting(folder), Counting(folder)
    run_loop(one, tmp_path, budget=0)
    other.identity = "another"
    with pytest.raises(SessionError, match="wanted another, got the only one"):
        run_loop(other, tmp_path, budget=0)
    (tmp_path / "laboratory").unlink()
    with pytest.raises(SessionError, match="got one that is not told"):
        run_loop(one, tmp_path, budget=0)
    assert (one.numbers, other.numbers) == ([1], [])


def test_a_session_and_a_laboratory_at_once_or_neither_are_refused():
    for arguments in (["gap"], ["gap", "some.h5", "--lab"]):
        result = CliRunner().invoke(app, arguments)
        assert isinstance(result.exception, SessionError)
        assert "wanted either a session or --lab" in str(result.exception)


LAB_ONLY = {
    "--lab-arm": "bench57",
    "--hide": "rotor",
    "--magnitude": "medium",
    "--seed": "1",
    "--budget": "2",
    "--out": "gap-lab",
}


@pytest.mark.parametrize("option", LAB_ONLY)
def test_an_option_of_the_laboratory_is_refused_with_a_session_also_at_its_default(option):
    result = CliRunner().invoke(app, ["gap", "some.h5", option, LAB_ONLY[option]])
    assert isinstance(result.exception, SessionError)
    assert f"wanted {option} with --lab only, got a session; leave it out" in str(result.exception)


def test_options_of_a_session_are_refused_with_a_laboratory_and_all_are_named():
    result = CliRunner().invoke(app, ["gap", "--lab", "--arm", "ur5", "--with", "some.h5"])
    assert isinstance(result.exception, SessionError)
    assert "wanted --with, --arm with a session only, got --lab" in str(result.exception)


def test_defaults_of_the_laboratory_pass_with_a_session(tmp_path):
    result = CliRunner().invoke(app, ["gap", str(tmp_path / "none.h5")])
    assert isinstance(result.exception, SessionError)
    assert "none.h5" in str(result.exception)
    assert "only" not in str(result.exception)


@pytest.mark.parametrize(("given", "meant"), [("0.5", 0.5), ("1", 1.0), ("faint", "faint")])
def test_a_magnitude_is_a_name_or_a_part_of_clear(monkeypatch, given, meant):
    asked = []

    def begun(seed, arm, kind, magnitude, *, ladder):
        asked.append((kind, magnitude))
        raise SessionError("far enough")

    monkeypatch.setattr(armodal.tui.gap_commands, "make_case", begun)
    CliRunner().invoke(app, ["gap", "--lab", "--hide", "softening", "--magnitude", given])
    assert asked == [("softening", meant)]


@pytest.mark.parametrize("given", ["huge", "0", "-0.5", "1.5", "nan", "inf", ""])
def test_another_magnitude_is_refused_before_anything_is_measured(tmp_path, given):
    folder = tmp_path / "lab"
    arguments = ["gap", "--lab", "--hide", "softening", "--out", str(folder), "--magnitude", given]
    result = CliRunner().invoke(app, arguments)
    assert isinstance(result.exception, SessionError)
    assert "--magnitude: wanted clear, medium, faint, or a number" in str(result.exception)
    assert not folder.exists()


def test_the_command_hits_at_levels_names_the_joint_and_tells_every_test_and_why(tmp_path):
    folder = tmp_path / "lab"
    where = ["--lab", "--lab-arm", "rv4frl", "--out", str(folder), "--budget", "1", "--seed", "5"]
    result = CliRunner().invoke(
        app, ["gap", *where, "--hide", "softening", "--magnitude", "clear", "--json"]
    )
    assert result.exit_code == 0, result.output
    said = json.loads(result.stdout)
    assert has_levels(read_session(folder / "test-1.h5"))
    assert [effect["name"] for effect in said["effects"]] == ["softening"]
    assert [effect["name"] for effect in said["truth"]["effects"]] == ["softening"]
    (test,) = said["tests"]
    assert test["number"] == 2
    assert test["words"]
    assert test["why"]
    assert (folder / "test-2.h5").exists()
