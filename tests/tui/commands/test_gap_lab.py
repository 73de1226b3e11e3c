"""`armodal gap --lab`: options of a session and of a laboratory, and the whole loop."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.chain_arm import chain_arm_text
from support.computed_once import computed_once
from support.gap_results import made_result
from support.small_case import small_case
from typer.testing import CliRunner

import armodal.study.closed_loop
import armodal.tui.commands.gap
from armodal.analyzer.gap.model.hit_levels import has_levels
from armodal.protocols.errors import PlanError, SessionError
from armodal.protocols.session.hdf5 import read_session
from armodal.study.closed_loop import run_loop
from armodal.tui.cli import app


def test_a_session_and_a_laboratory_at_once_or_neither_are_refused():
    for arguments in (["gap"], ["gap", "some.h5", "--lab"]):
        result = CliRunner().invoke(app, arguments)
        assert isinstance(result.exception, SessionError)
        assert "wanted either a session or --lab" in str(result.exception)


LAB_ONLY = {
    "--lab-arm": "bench57",
    "--lab-plan": "my-plan.toml",
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

    monkeypatch.setattr(armodal.tui.commands.gap, "make_case", begun)
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


@pytest.fixture
def laboratory(tmp_path, monkeypatch):
    """Arguments of a small laboratory."""
    monkeypatch.setattr(armodal.tui.commands.gap, "make_case", small_case)
    where = ["--lab-arm", "bench57", "--out", str(tmp_path / "lab"), "--seed", "1"]
    return ["gap", "--lab", *where, "--hide", "softening"]


def test_the_command_hits_at_levels_and_tells_the_truth_beside_what_was_found(
    laboratory, tmp_path, monkeypatch
):
    result = made_result("ambiguous", [], standing=["softening", "friction"])
    found = SimpleNamespace(result=replace(result, summary="two stand"))
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: found)
    for_machines = CliRunner().invoke(app, [*laboratory, "--json"])
    assert for_machines.exit_code == 0, for_machines.output
    said = json.loads(for_machines.stdout)
    assert has_levels(read_session(tmp_path / "lab" / "test-1.h5"))
    assert [rival["name"] for rival in said["rivals"]] == ["softening", "friction"]
    assert [effect["name"] for effect in said["truth"]["effects"]] == ["softening"]
    for_people = CliRunner().invoke(app, laboratory)
    shown = " ".join(for_people.stdout.split())
    assert "two stand" in shown
    assert "in truth: softening" in shown


def test_the_laboratory_is_of_any_arm_file(tmp_path, monkeypatch):
    path = tmp_path / "two.toml"
    path.write_text(chain_arm_text(2, name="two"), encoding="utf-8")
    found = SimpleNamespace(result=replace(made_result("ambiguous", []), summary="none"))
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: found)
    arguments = ["gap", "--lab", "--lab-arm", str(path), "--hide", "delay", "--budget", "0"]
    result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / "lab"), "--json"])
    assert result.exit_code == 0, result.output
    (effect,) = json.loads(result.stdout)["truth"]["effects"]
    assert effect["name"] == "delay"
    session = read_session(tmp_path / "lab" / "test-1.h5")
    assert session.header.arm.name == "two"
    assert session.header.plan.name == "two-rehearsal"


def test_a_plan_that_cannot_size_an_effect_is_refused(tmp_path):
    path = tmp_path / "lab"
    arguments = ["gap", "--lab", "--lab-arm", "rv4frl", "--lab-plan", "rv4frl-roving-hammer"]
    result = CliRunner().invoke(app, [*arguments, "--hide", "delay", "--out", str(path)])
    assert isinstance(result.exception, PlanError)
    assert "leave --lab-plan out" in str(result.exception)
    assert not path.exists()


@pytest.mark.long
def test_the_command_hits_at_levels_names_the_joint_and_tells_every_test_and_why(
    laboratory, tmp_path, monkeypatch
):
    monkeypatch.setattr(armodal.tui.commands.gap, "run_loop", computed_once(run_loop))
    folder = tmp_path / "lab"
    asked = [*laboratory, "--budget", "1"]
    result = CliRunner().invoke(app, [*asked, "--magnitude", "clear", "--json"])
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
    for_people = CliRunner().invoke(app, [*asked, "--arm-out", str(folder / "again.toml")])
    shown = " ".join(for_people.stdout.split())
    for words in (f"test 2: {test['words']}", said["summary"], "in truth: softening"):
        assert words in shown
