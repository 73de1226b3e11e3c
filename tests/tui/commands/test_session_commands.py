"""Commands that need a session, as a user calls them: identify by Eq. 13, predict, report."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path

import pytest
from support.computed_once import computed_once
from support.viper_session import true_values, viper_session
from typer.testing import CliRunner

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.predicted_posture import predict_posture
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.session.hdf5 import read_session, write_session
from armodal.tui.cli import app
from armodal.tui.commands.predict import prediction_tables


@pytest.fixture(scope="module")
def session_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("viper")
    path = folder / "session.h5"
    write_session(viper_session(folder), path)
    return str(path)


@pytest.fixture(scope="module", autouse=True)
def identified(session_file):
    """What every command here identifies, once for all: by the first that asks."""
    once = computed_once(identify)
    with pytest.MonkeyPatch.context() as patch:
        for command in ("identify", "predict", "report"):
            module = import_module(f"armodal.tui.commands.{command}")
            patch.setattr(module, "identify", once)
        yield lambda: once(read_session(Path(session_file)))


def run(*arguments: str):
    return CliRunner().invoke(app, list(arguments), catch_exceptions=True)


def value_of(*arguments: str):
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def refused(*arguments: str) -> str:
    result = run(*arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    return str(result.exception)


def test_postures_are_predicted_for_people_and_machines(session_file):
    asked = ("--posture=0,30,30,0,90,0", "--posture=30,-50,160,0,90,0")
    value = value_of("predict", session_file, *asked, "--json")
    assert [row["posture_deg"][1] for row in value["postures"]] == [30.0, -50.0]
    for row in value["postures"]:
        assert len(row["modes"]) == 5
        for mode in row["modes"]:
            assert mode["f_half_width_95_hz"] > mode["f_std_hz"] > 0
            assert mode["f_std_model_hz"] > 0
            assert mode["damping_std"] > 0
            assert sum(mode["strain_share"].values()) == pytest.approx(1.0)
            assert max(abs(part["real"]) for part in mode["shape"].values()) == pytest.approx(1.0)
            assert set(mode["point_shape_m_per_rad"]) == {str(i) for i in range(1, 11)}


def test_a_prediction_is_told_in_tables(identified):
    arm = load_arm("viper_s650")
    found = predict_posture(arm, identified(), [0.0, 30.0, 30.0, 0.0, 90.0, 0.0])
    modes, shapes = prediction_tables(found)
    assert str(modes.title).startswith("Predicted at 0 30 30 0 90 0 deg")
    assert modes.row_count == len(shapes.columns) - 1 == 5


@pytest.mark.parametrize(
    ("posture", "message"),
    [("0,30", "wanted 6 joint angles"), ("0,300,0,0,0,0", "joint_2"), ("a", "separated by commas")],
)
def test_a_posture_that_cannot_be_is_refused_before_the_fit(session_file, posture, message):
    assert message in refused("predict", session_file, "--posture", posture)


def test_the_penalty_method_stands_beside_the_whole_fit(session_file):
    value = value_of(
        "identify", session_file, "--method", "eq13", "--joints", "1,joint_3", "--json"
    )
    rows = {row["joint"]: row for row in value["eq13"]["joints"]}
    assert [name for name, row in rows.items() if row["chosen"]] == ["joint_1", "joint_3"]
    k, _ = true_values(load_arm("viper_s650"))
    assert rows["joint_3"]["k_n_m_per_rad"] == pytest.approx(k[2], rel=0.01)
    assert rows["joint_2"]["k_n_m_per_rad"] == rows["joint_2"]["start_n_m_per_rad"]
    whole = {row["joint"]: row["k_n_m_per_rad"] for row in value["joints"]}
    assert rows["joint_1"]["k_whole_frfs_n_m_per_rad"] == whole["joint_1"]
    assert {row["posture"] for row in value["eq13"]["pairs"]} == {"test 1", "test 2"}
    assert value["validation"][0]["measured_damping"] is not None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--joints", "1"), "--joints chooses joints for --method eq13"),
        (("--method", "eq13", "--joints", "9"), "by name or number 1 to 6"),
        pytest.param(
            ("--method", "eq13", "--joints", "6"),
            "has no stiffness in the arm file",
            marks=pytest.mark.long,
        ),
        pytest.param(
            ("--method", "eq13", "--joints", ""), "by name or number", marks=pytest.mark.long
        ),
    ],
)
def test_joints_that_cannot_be_chosen_are_refused(session_file, arguments, message):
    assert message in refused("identify", session_file, *arguments)


def test_picked_poles_that_are_not_there_or_of_another_session_are_refused(session_file, tmp_path):
    path = tmp_path / "other.picked.json"
    assert "is not there" in refused("identify", session_file, "--picked", str(path))
    path.write_text(
        json.dumps({"format": "armodal-picked-poles-1", "session_id": "f" * 32, "postures": {}})
    )
    assert "belongs to session" in refused("identify", session_file, "--picked", str(path))


def test_the_report_holds_the_workspace_of_what_was_identified(session_file, tmp_path):
    path = tmp_path / "report.html"
    value = value_of("report", session_file, "--workspace", "2000", "--out", str(path), "--json")
    html = Path(value["report"]).read_text(encoding="utf-8")
    for title in ("Workspace, with the identified stiffness", "Mass matrix of", "Modes of",
                  "Coupling of joints 2 and 3", "Frequency of mode 3"):  # fmt: skip
        assert title in html
    assert "<script src=" not in html
