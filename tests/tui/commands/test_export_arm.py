"""`armodal export ARM` for simulators."""

from __future__ import annotations

import json

import pytest
from support.added import any_of, axis
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmodalError, MissingPackageError
from armodal.tui.cli import app
from armodal.tui.command_parts import export_arm

pytest.importorskip("mujoco")
RV = load_arm("rv4frl")


def run(*arguments):
    return CliRunner().invoke(app, ["export", *map(str, arguments)])


@pytest.fixture
def corrected(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(text_with_effects(RV, [axis("shoulder")]), encoding="utf-8")
    return path


def test_an_arm_file_becomes_three_files_and_mujoco_agrees(corrected, tmp_path):
    out = {form: tmp_path / f"arm.{form}" for form in ("mjcf", "urdf", "sdf")}
    options = [part for form, path in out.items() for part in (f"--{form}", path)]
    value = json.loads(run(corrected, *options, "--json").stdout)
    assert value["files"] == [str(path) for path in out.values()]
    assert value["mujoco"]["postures"] == 20
    assert value["mujoco"]["largest_difference"] < 1e-6
    assert "axis_compliance_shoulder" in value["elastic_joints"]
    assert all(path.stat().st_size for path in out.values())
    assert "within 0.0000 % of the arm file's" in run(corrected, "--mjcf", out["mjcf"]).stdout


def test_without_mujoco_it_is_written_and_said_unchecked(corrected, tmp_path, monkeypatch):
    def missing():
        raise MissingPackageError("not installed")

    monkeypatch.setattr(export_arm, "load_mujoco", missing)
    value = json.loads(run(corrected, "--mjcf", tmp_path / "arm.xml", "--json").stdout)
    assert value["notes"] == ["not checked: the package mujoco is not installed"]


def test_frequencies_that_are_others_leave_nothing_behind(corrected, tmp_path, monkeypatch):
    monkeypatch.setattr(export_arm, "_AGREE", 0.0)
    result = run(corrected, "--mjcf", tmp_path / "out.xml")
    assert "wanted MuJoCo's frequencies within" in str(result.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["arm.toml"]


def test_a_link_whose_mass_lies_near_together_bends_in_mujoco_as_in_the_arm_file(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(text_with_effects(RV, [any_of(RV, "link_bending")]), encoding="utf-8")
    value = json.loads(run(path, "--mjcf", tmp_path / "out.xml", "--json").stdout)
    assert value["mujoco"]["largest_difference"] < 1e-3  # gravity, to second order


def test_an_effect_without_a_counterpart_leaves_nothing_behind(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(text_with_effects(RV, [any_of(RV, "rotor")]), encoding="utf-8")
    result = run(path, "--mjcf", tmp_path / "arm.xml", "--urdf", tmp_path / "arm.urdf")
    assert "write --mjcf, which has all of it" in str(result.exception)
    assert [own.name for own in tmp_path.iterdir()] == ["arm.toml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--mjcf", "a.xml", "--out", "b.uff"), "wanted --out with a session only"),
        (("--from", "mine.xml"), "wanted --from with --mjcf or --urdf only"),
        (("--sdf", "a.sdf", "--from", "mine.sdf"), "got --sdf"),
        (("--mjcf", "a.xml", "--urdf", "a.urdf", "--from", "mine.xml"), "of which mine.xml is one"),
        (("--mjcf", "a.xml", "--from", "mine.xml"), "wanted a readable file, found none"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = run("rv4frl", *arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)
