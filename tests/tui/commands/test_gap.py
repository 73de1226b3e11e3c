"""`armodal gap` as a user calls it, also on FRFs that others averaged."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.gap_results import made_result
from support.small_case import small_case
from typer.testing import CliRunner

import armodal.tui.commands.gap
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.report import read_gap
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError, ArmodalError, EstimateError
from armodal.protocols.session.hdf5 import write_session
from armodal.tui.cli import app
from armodal.tui.command_parts.gap_results import with_arm


@pytest.fixture(scope="module")
def averaged():
    """A session that has no hits, only FRFs with their coherence."""
    return without_hits(small_case(2, "bench57").session())


@pytest.fixture(scope="module")
def hidden():
    """The case of such a session in which an axis is hidden."""
    return small_case(2, "bench57", "link_axis")


def without_hits(session):
    return replace(session, hits=(), frfs=estimate_frfs(session, Superset(session.header.arm)))


@pytest.fixture(scope="module")
def imported(averaged, tmp_path_factory):
    """Its file."""
    path = tmp_path_factory.mktemp("gap") / "imported.h5"
    write_session(averaged, path)
    return path


@pytest.fixture(scope="module")
def found(hidden, tmp_path_factory):
    path = tmp_path_factory.mktemp("hidden") / "imported.h5"
    write_session(without_hits(hidden.session()), path)
    result = run("gap", str(path), "--json", "--html", str(path.with_suffix(".html")))
    assert result.exit_code == 0, result.output
    return path, json.loads(result.stdout)


def run(*arguments: str):
    return CliRunner().invoke(app, list(arguments), catch_exceptions=True)


def refused(*arguments: str) -> ArmodalError:
    result = run(*arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    return result.exception


@pytest.mark.long
def test_averaged_frfs_are_enough_to_name_an_axis_and_what_stays_closed_is_said(hidden, found):
    _, value = found
    truth = json.loads(hidden.open_truth())["effects"][0]
    assert value["verdict"] == "named"
    (effect,) = value["effects"]
    assert effect["name"] == "link_axis"
    assert effect["place"] == truth["place"]
    low, high = effect["interval_95"][effect["size"]]
    assert low < effect["parameters"][effect["size"]] < high
    assert effect["std"][effect["size"]] > 0
    assert 0.5 < effect["confidence"] <= 1
    assert any("only averaged FRFs" in note for note in value["notes"])
    assert all(row["low"] < row["k_n_m_per_rad"] for row in value["joint_stiffness_ranges"])
    assert {row["posture"] for row in value["gap_before"]} == {
        row["posture"] for row in value["gap_after"]
    }


def test_what_was_found_lies_beside_the_session_with_a_page(imported, tmp_path, monkeypatch):
    path = Path(shutil.copy(imported, tmp_path / "s.h5"))
    result = made_result("ambiguous", [], standing=["softening", "friction"])
    found = SimpleNamespace(result=replace(result, summary="two stand"))
    monkeypatch.setattr(armodal.tui.commands.gap, "find_gap", lambda *_, **__: found)
    said = run("gap", str(path), "--json", "--html", str(tmp_path / "page.html"))
    value = json.loads(said.stdout)
    assert value["arm_file"] is None  # nothing was named
    assert value["result"] == str(path.with_suffix(".gap.json"))
    assert read_gap(path.with_suffix(".gap.json")) == found.result
    assert "two stand" in (tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_the_result_lies_beside_the_session_with_an_arm_file_and_a_page(found):
    path, value = found
    assert read_gap(path.with_suffix(".gap.json")).verdict.value == value["verdict"]
    arm = load_arm(value["arm_file"])
    assert [(e.name, e.place) for e in arm.effects] == [("link_axis", value["effects"][0]["place"])]
    page = path.with_suffix(".html").read_text(encoding="utf-8")
    assert "Link is compliant about an axis of its own" in page


@pytest.mark.long
def test_believing_the_new_arm_nothing_more_is_missing(found, tmp_path):
    path, value = found
    arms = ("--arm", value["arm_file"], "--arm-out", str(tmp_path / "again.toml"))
    again = run("gap", str(path), *arms, "--json")
    assert again.exit_code == 0, again.output
    second = json.loads(again.stdout)
    assert not second["effects"]
    assert second["verdict"] == "nothing_detectable"
    assert second["arm_file"] is None


def test_an_arm_that_does_not_match_is_refused(averaged, imported):
    problem = refused("gap", str(imported), "--arm", "rv4frl")
    assert isinstance(problem, ArmError)
    assert "does not match the session: wanted the joints" in str(problem)
    arm = averaged.header.arm
    moved = replace(arm.points[0], position_m=arm.points[0].position_m + 0.01)
    with pytest.raises(ArmError, match=r"not where the session measured it \(17 mm off"):
        with_arm(averaged, replace(arm, points=(moved, *arm.points[1:])))


def test_too_few_postures_or_points_say_what_to_measure(averaged, tmp_path):
    one = tmp_path / "one.h5"
    write_session(replace(averaged, frfs=averaged.frfs[:1]), one)
    problem = refused("gap", str(one))
    assert isinstance(problem, EstimateError)
    assert "at least 2 postures" in str(problem)
    assert "measure" in str(problem)
    assert not one.with_suffix(".gap.json").exists()
