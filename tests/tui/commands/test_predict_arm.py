"""`armodal predict --arm`."""

from __future__ import annotations

import json

import pytest
from support.added import any_of, axis
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import load_plan
from armodal.tui.cli import app

POSTURE = "--posture=0,30,30,0,90,0"


def run(*arguments):
    return CliRunner().invoke(app, ["predict", *arguments])


@pytest.fixture(scope="module")
def corrected(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.toml"
    text = text_with_effects(load_arm("rv4frl"), [axis("shoulder")])
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_an_arm_file_s_effects_are_in_its_modes(corrected):
    with_axis = json.loads(run("--arm", corrected, POSTURE, "--json").stdout)
    plain = json.loads(run("--arm", "rv4frl", POSTURE, "--json").stdout)
    assert with_axis["effects"] == ["link_axis (shoulder)"]
    modes, fewer = with_axis["postures"][0]["modes"], plain["postures"][0]["modes"]
    assert len(modes) == len(fewer) + 1
    # What gives way beside lowers every mode (Cauchy's interlacing), some by much.
    lower = [m["f_hz"] / p["f_hz"] for m, p in zip(modes, fewer, strict=False)]
    assert max(lower) < 1.0
    assert min(lower) < 0.97
    assert modes[0]["f_std_hz"] > 0.0


def test_people_read_which_spring_holds_a_mode(corrected):
    said = run("--arm", corrected, POSTURE).output
    assert "with link_axis (shoulder)" in said
    assert "axis compliance" in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((POSTURE,), "wanted either a session"),
        (("s.h5", "--arm", "rv4frl", POSTURE), "got both"),
        (("--arm", "rv4frl", POSTURE, "--level=0"), "wanted a positive ratio of forces, got 0"),
        (("s.h5", POSTURE, "--level=2"), "wanted --level with --arm only"),
        (("--arm", "rv4frl", "--posture=0,1"), "angles"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = run(*arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)


@pytest.mark.long
def test_a_plan_for_an_arm_with_an_axis_counts_with_its_mode(corrected, small_search):
    value = json.loads(CliRunner().invoke(app, ["plan", corrected, "--tests=3", "--json"]).stdout)
    (note,) = value["notes"]
    assert note == "planned with: Link is compliant about an axis of its own (shoulder)"
    assert all(len(test["modes"]) == 4 for test in value["tests"])  # of three joints and the axis


@pytest.mark.long
def test_a_plan_for_an_arm_with_a_payload_is_of_the_loaded_links(tmp_path, small_search):
    arm = load_arm("rv4frl")
    path, plan = tmp_path / "arm.toml", tmp_path / "plan.toml"
    path.write_text(text_with_effects(arm, [any_of(arm, "payload")]), encoding="utf-8")
    arguments = ["--tests=3", "--out", str(plan), "--json"]
    with_load, without = (
        json.loads(CliRunner().invoke(app, ["plan", own, *rest]).stdout)
        for own, rest in ((str(path), arguments), ("rv4frl", ["--tests=3", "--json"]))
    )
    assert load_plan(plan, load_arm(path)).fixed_point == with_load["hit_point"]
    counted, room = with_load["notes"]
    assert counted.startswith("planned with: ")
    assert room == "the room that its payload takes is not known"
    assert without["notes"] == []
    assert with_load["most_selective"] != without["most_selective"]


def test_the_tool_gives_way_more_with_what_effects_let_give_way(corrected):
    arguments = ["--posture=0,30,60,0,40,0", "--wrench=0,50,-100,0,0,0", "--json"]
    found, plain = (
        json.loads(CliRunner().invoke(app, ["mozzi", arm, *arguments]).stdout)
        for arm in (corrected, "rv4frl")
    )
    assert [row["joint"] for row in found["joints"]][-1] == "axis compliance shoulder"
    assert abs(found["displacement_m"][2]) > abs(plain["displacement_m"][2])
    shares = [row["share_of_displacement"] for row in found["joints"]]
    assert sum(shares) == pytest.approx(1.0)


def test_a_workspace_s_statistics_are_of_the_corrected_arm(corrected, tmp_path):
    arguments = ["--postures=300", "--out", str(tmp_path / "w"), "--json"]
    value = json.loads(CliRunner().invoke(app, ["workspace", corrected, *arguments]).stdout)
    assert value["freedoms"][-1] == "axis compliance shoulder"
    assert len(value["f_mean_hz"]) == 4
    assert len(value["mass_mean_kg_m2"]) == 6
