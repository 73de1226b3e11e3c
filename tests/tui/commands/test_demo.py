"""The demo with fewer points: everything real, the object `armodal demo --json` prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import PLANS_DIRECTORY
from armodal.protocols.session.journal import load_journal
from armodal.tui.commands.demo_run import run_demo

FEW_POINTS = 'points = ["1", "4", "6", "9", "12", "14"]'


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    plan = folder / "few.toml"
    plan.write_text(re.sub(r"points = \[[^\]]*\]", FEW_POINTS, text))
    value, _, _ = run_demo(
        folder / "out",
        seed=5,
        software="test",
        show=lambda event: None,
        say=lambda text: None,
        plan_name=str(plan),
    )
    return value


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


def test_stiffness_is_near_the_truth_even_so(found):
    for row in found["joints"]:
        truth = row["truth_k_n_m_per_rad"]
        assert abs(row["k_n_m_per_rad"] - truth) < 0.02 * truth
    (axis,) = found["structural"]
    truth = axis["truth_k_n_m_per_rad"]
    assert abs(axis["k_n_m_per_rad"] - truth) < 0.05 * truth
    assert axis["axis_angle_error_deg"] < 3
    assert axis["axis_distance_error_mm"] < 15


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
