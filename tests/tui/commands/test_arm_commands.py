"""Commands that need an arm and no measurement, as a user calls them."""

from __future__ import annotations

import json
import re
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest
from support.computed_once import computed_once
from typer.testing import CliRunner

from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import load_plan
from armodal.tui.cli import app

TARGETS = ARMS_DIRECTORY.parent / "targets"


def run(*arguments: str):
    return CliRunner().invoke(app, list(arguments), catch_exceptions=True)


def value_of(*arguments: str):
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def refused(*arguments: str) -> str:
    """The message of a user's mistake; `main` prints it and exits with code 2."""
    result = run(*arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    return str(result.exception)


def told_to_machines_and_people(monkeypatch, module, name, *arguments):
    """Return what a command prints with and without `--json`; it computes `name` once for both."""
    where = import_module(f"armodal.tui.commands.{module}")
    monkeypatch.setattr(where, name, computed_once(getattr(where, name)))
    value = value_of(*arguments, "--json")
    if "--out" in arguments:
        Path(arguments[arguments.index("--out") + 1]).unlink()
    shown = run(*arguments)
    assert shown.exit_code == 0, shown.output
    return value, shown.stdout


# Statements of file 002 to which the computed answer is no, each with its reason.
DENIED = {
    "joints 2 and 3 alone give similar standard deviations of modes 4 and 5",
    "that band is 15 to 30 Hz",
}


def test_every_published_figure_has_a_status_and_only_denied_statements_differ(monkeypatch):
    figures, shown = told_to_machines_and_people(
        monkeypatch, "reproduce", "reproduce_papers", "reproduce", "--postures", "20000"
    )
    models = {model["arm"]: model for model in figures["models"]}
    assert (models["rv4frl"]["parameters"], models["rv4frl"]["figures"]) == (1, 3)
    # Six links of ten numbers and the base's mass; Table 4 has 20 figures.
    two = [models[name] for name in ("viper_s650-without-table4", "viper_s650")]
    assert [(m["parameters"], m["figures"]) for m in two] == [(61, 8), (61, 28)]
    figures = figures["figures"]
    for status, number in Counter(figure["status"] for figure in figures).items():
        assert re.search(rf"^ *{status} +{number} *$", shown, re.MULTILINE)
    assert {figure["paper"] for figure in figures} == {"000", "001", "002", "003"}
    keys = {"paper", "table", "item", "published", "ours", "margin", "status"}
    assert all(keys <= set(figure) for figure in figures)
    denied = [f for f in figures if f["status"] == "differs"]
    assert {f["item"] for f in denied} == DENIED
    assert all(f["ours"] is False and ";" in f["why"] for f in denied)  # the number; the reason
    assert all(f["ours"] is None for f in figures if f["status"] == "not derivable")
    assert {f["status"] for f in figures} == {
        "predicted",
        "calibrated-to",
        "recomputed",
        "erratum",
        "not derivable",
        "differs",
        "sister paper",
        "by geometry",
    }
    fitted = [f for f in figures if f["paper"] == "000" and f["status"] == "calibrated-to"]
    assert len(fitted) == 9  # six of Table 4 by one density, three of Table 3 by all joints
    assert not [f for f in figures if f["paper"] == "000" and f["status"] == "predicted"]
    of_001 = [f for f in figures if f["paper"] == "001" and f["table"] == "Table 3"]
    # The three numerical frequencies from the paper's own three inertias.
    assert [round(f["ours"], 1) for f in of_001] == [15.2, 15.9, 39.2]
    predicted = [f for f in figures if f["table"] == "Table 4" and f["status"] == "predicted"]
    # Two standard deviations hold 95 %: 19 of 20; two damping ratios are printed to 0.1 points.
    pulls = [abs(f["ours"] - f["published"]) / f["ours_std"] for f in predicted if f["ours_std"]]
    assert len(pulls) == 20
    assert sorted(pulls)[17] < 2.0


def test_a_plan_is_written_beside_the_papers_postures_and_a_session_can_run_it(
    tmp_path, monkeypatch, small_search
):
    path = tmp_path / "plan.toml"
    value, shown = told_to_machines_and_people(
        monkeypatch, "plan", "made_plan",
        "plan", "viper_s650", "--tests", "3", "--minutes", "60", "--out", str(path)
    )  # fmt: skip
    # All ten points would take 62 minutes: one mounting of 1.75 is spared.
    assert 60.0 - 1.75 < value["minutes"] <= 60.0
    assert not any(test["validation"] for test in value["tests"])
    assert "Tests for viper_s650: the first " in " ".join(shown.split())
    for mode in value["tests"][0]["modes"]:
        assert f"{mode['f_hz']:.1f}" in shown
    plan = load_plan(path, load_arm("viper_s650"))
    assert len(plan.postures) == len(value["tests"]) == 3
    assert sum(len(posture.points) for posture in plan.postures) == value["mountings"]
    assert plan.fixed_point == value["hit_point"]
    assert value["beside"]["plan"] == "viper_s650-five-tests"
    for found, theirs in zip(value["most_selective"], value["beside"]["joints"], strict=True):
        assert found["joint"] == theirs["joint"]
        assert found["worst_coupling"] <= theirs["worst_coupling"]
    assert "exists already" in refused("plan", "viper_s650", "--out", str(path))


def test_the_tool_s_motion_is_told_for_people_and_machines():
    arguments = ("mozzi", "rv4frl", "--posture", "0,20,80,0,60,0", "--wrench", "0,100,0,0,0,0")
    value = value_of(*arguments, "--json")
    assert value["kind"] == "turns about an axis"
    assert value["joints"][0]["share_of_displacement"] == pytest.approx(1.0)
    assert "joint_1" in run(*arguments).stdout


def test_a_place_of_the_wrist_serves_as_a_posture():
    value = value_of(
        "mozzi", "viper_s650", "--wrist", "0.4,0.5", "--elbow", "down", "--wrench",
        "0,0,-100,0,0,0", "--at", "0,0,-0.08", "--json"
    )  # fmt: skip
    # The wrist is where joints 4 and 5 cross, 80 mm behind the flange's frame.
    assert value["tool_m"] == pytest.approx([0.4, 0.0, 0.5], abs=1e-9)


def test_no_load_is_no_motion():
    value = value_of(
        "mozzi", "rv4frl", "--posture", "0,0,0,0,0,0", "--wrench", "0,0,0,0,0,0", "--json"
    )
    assert value["kind"] == "no motion"
    assert value["axis"] is None


def test_random_postures_are_ranked():
    rows = value_of(
        "mozzi", "rv4frl", "--rank", "500", "--best", "3", "--wrench", "0,0,-50,0,0,0", "--json"
    )["postures"]
    sizes = [row["displacement_m"] for row in rows]
    assert len(sizes) == 3
    assert sizes == sorted(sizes)


def test_a_workspace_is_surveyed_into_page_and_arrays(tmp_path):
    arguments = ("workspace", "rv4frl", "--postures", "2000", "--out", str(tmp_path / "w"))
    value = value_of(*arguments, "--json")
    assert f"{value['f_mean_hz'][0]:.2f}" in run(*arguments).stdout
    page = (tmp_path / "w" / "workspace.html").read_text()
    assert value["page"].endswith("workspace.html")
    assert "Frequency of mode 1" in page
    assert "<script src=" not in page  # one file, nothing loaded from elsewhere
    assert (tmp_path / "w" / "workspace.npz").stat().st_size > 0


def test_inertias_are_calibrated_into_a_new_arm(tmp_path, monkeypatch):
    path = tmp_path / "viper.toml"
    value, shown = told_to_machines_and_people(
        monkeypatch,
        "calibrate_inertia",
        "calibrate",
        "calibrate-inertia",
        str(TARGETS / "viper_s650-uncalibrated.toml"),
        str(TARGETS / "viper_s650-without-table4.toml"),
        "--out",
        str(path),
    )
    for link in value["links"]:
        assert f"{link['mass_kg']:.3f}" in shown
    arm = load_arm(path)
    assert arm.name == "viper"
    assert [link["mass_kg"] for link in value["links"]] == pytest.approx(
        [joint.link.mass_kg for joint in arm.joints],
        rel=1e-5,  # six digits in the file
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("mozzi", "rv4frl", "--posture", "0,0,0", "--wrench", "1,2,3,4,5,6"), "6 joint angles"),
        (
            ("mozzi", "rv4frl", "--posture", "0,0,0,0,0,0", "--wrench", "1,2,3"),
            "wanted 6 numbers",
        ),
        (
            ("mozzi", "rv4frl", "--posture", "0,200,0,0,0,0", "--wrench", "1,2,3,4,5,6"),
            "joint_2 of arm",
        ),
        (("mozzi", "rv4frl", "--wrench", "1,2,3,4,5,6"), "--posture"),
        (("mozzi", "rv4frl", "--rank", "9", "--wrench", "0,0,0,1,0,0"), "a wrench with a force"),
        (
            ("mozzi", "rv4frl", "--wrist", "3,0", "--wrench", "1,2,3,4,5,6"),
            "does not reach (3.000, 0.000) m",
        ),
        (("plan", "no_such_arm"), "no_such_arm"),
        (
            ("plan", "viper_s650", "--beside", "rv4frl-three-postures"),
            "wanted viper_s650, the arm that is given",
        ),
        (("workspace", "no_such_arm"), "no_such_arm"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    assert message in refused(*arguments)
