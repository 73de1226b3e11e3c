"""The demo with fewer points: everything real, the object `armodal demo --json` prints."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.gap_results import made_result
from typer.testing import CliRunner

import armodal.tui.command_parts.demo_run
import armodal.tui.commands.demo
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import PLANS_DIRECTORY
from armodal.protocols.session.journal import load_journal
from armodal.tui.cli import app
from armodal.tui.command_parts.demo_run import run_demo

FEW_POINTS = ("1", "4", "6", "9", "12", "14")


def demo(folder, *, points=FEW_POINTS, postures=5, hits=3):
    """Return the demo by a plan of the shipped one's first postures."""
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    text = "[[postures]]".join(text.split("[[postures]]")[: postures + 1])
    text = text.replace("hits_per_point = 3", f"hits_per_point = {hits}")
    text = re.sub(r"points = \[[^\]]*\]", f"points = {json.dumps(list(points))}", text)
    plan = folder / "few.toml"
    plan.write_text(text)
    return partial(run_demo, plan_name=str(plan))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    value, _, _ = demo(folder)(
        folder / "out",
        seed=5,
        software="test",
        show=lambda event: None,
        say=lambda text: None,
    )
    return value


def short_demo(folder, monkeypatch):
    """Output of a demo by two postures of four points, 16 hits."""
    run = demo(folder, points=("1", "6", "9", "14"), postures=2, hits=2)
    monkeypatch.setattr(armodal.tui.commands.demo, "run_demo", run)
    said = CliRunner().invoke(app, ["demo", "--out", str(folder / "out"), "--seed", "5"])
    assert said.exit_code == 0, said.output
    return said.output


def test_a_short_demo_runs_from_hits_to_truth_and_a_report(tmp_path, monkeypatch):
    """The search for a gap is left out: `found` has it."""
    nothing = SimpleNamespace(result=made_result("nothing_detectable", []))
    monkeypatch.setattr(
        armodal.tui.command_parts.demo_run, "find_gap", lambda session, tell: nothing
    )
    said = short_demo(tmp_path, monkeypatch)
    for words in ("16 hits accepted", "joint_1", "truth", "report "):
        assert words in said
    assert (tmp_path / "out" / "report.html").exists()


@pytest.mark.long
def test_a_short_demo_says_what_its_gap_is_and_where_its_corrected_arm_is(tmp_path, monkeypatch):
    said = short_demo(tmp_path, monkeypatch)
    assert "gap between model and measurement" in said
    assert "arm file" in said


@pytest.mark.long
def test_the_object_holds_what_is_promised(found):
    joint = {
        "joint",
        "k_n_m_per_rad",
        "k_std",
        "k_std_model",
        "truth_k_n_m_per_rad",
        "k_one_joint_n_m_per_rad",
        "c_n_m_s_per_rad",
    }
    structural = {
        "f_hz",
        "k_n_m_per_rad",
        "k_std",
        "truth_k_n_m_per_rad",
        "axis_angle_error_deg",
        "axis_distance_error_mm",
    }
    validation = {"posture", "mode", "predicted_hz", "predicted_std_hz", "measured_hz"}
    assert len(found["joints"]) == 3
    assert all(joint <= set(row) for row in found["joints"])
    assert all(structural <= set(row) for row in found["structural"])
    assert found["structural"]
    assert all(validation <= set(row) for row in found["validation"])
    assert len(found["validation"]) == 8
    assert found["modes"]
    assert found["hits"]["accepted"] == 3 * 6 * 5
    hits = load_journal(Path(found["session"]).with_name("demo.journal")).hits
    assert found["hits"]["rejected"] == sum(not hit.verdict.accepted for hit in hits)
    assert sum(found["hits"].values()) == len(hits)
    assert found["complete"]
    assert found["wall_s"] > 0


@pytest.mark.long
def test_stiffness_is_near_the_truth_even_so(found):
    for row in found["joints"]:
        truth = row["truth_k_n_m_per_rad"]
        assert abs(row["k_n_m_per_rad"] - truth) < 0.02 * truth
    (axis,) = found["structural"]
    truth = axis["truth_k_n_m_per_rad"]
    assert abs(axis["k_n_m_per_rad"] - truth) < 0.05 * truth
    assert axis["axis_angle_error_deg"] < 3
    assert axis["axis_distance_error_mm"] < 15


@pytest.mark.long
def test_the_missing_axis_is_named_added_and_the_gap_shrinks(found):
    gap = found["gap"]
    assert gap["verdict"] == "named"
    (effect,) = gap["effects"]
    assert effect["name"] == "link_axis"
    assert effect["place"] == "shoulder"
    # Masses and gains of the arm file are some per cent off, and six points tell little of them.
    assert abs(effect["k_n_m_per_rad"] / effect["truth_k_n_m_per_rad"] - 1.0) < 0.1
    arm = load_arm(gap["arm_file"])
    assert [added.name for added in arm.effects] == ["link_axis"]
    for before, after in zip(gap["gap_before"], gap["gap_after"], strict=True):
        if after["held_out"]:
            assert after["frf_error"] < before["frf_error"] / 2
