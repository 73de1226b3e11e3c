"""`armodal shaper`."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from armodal.protocols.errors import ArmodalError
from armodal.tui.cli import app

POSTURE = "--posture=0,30,30,0,90,0"


def run(*arguments):
    return CliRunner().invoke(app, ["shaper", *map(str, arguments)])


def test_shapers_are_told_for_people_and_machines(tmp_path):
    value = json.loads(run("ur5", "--posture=0,-60,60,0,60,0", "--json").stdout)
    kinds = [own["kind"] for own in value["shapers"]]
    assert kinds == ["zv", "mzv", "ei", "2-hump", "notch"]
    assert value["recommended"] in kinds
    assert len(value["modes"]) == 1
    assert sum(value["shapers"][0]["amplitudes"]) == pytest.approx(1.0)
    path = tmp_path / "path.csv"
    path.write_text("a,b,c,d,e,f\n0,-60,60,0,60,0  # first\n\n0,-70,80,0,60,0\n")
    assert json.loads(run("ur5", "--path", path, "--json").stdout)["postures"] == 2
    assert "take this" in run("ur5", "--path", path).stdout


def test_a_limit_that_none_holds_is_said():
    value = json.loads(run("rv4frl", POSTURE, "--limit=0.01", "--json").stdout)
    assert value["notes"][0].startswith("no shaper stays below 0.01 %")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2,3\n", "line 1: 3 numbers"),
        ("0,30,30,0,90,0\n1,2,x,4,5,6\n", "line 2: '1,2,x,4,5,6'"),
        ("", "got 0 postures"),
    ],
)
def test_a_path_of_other_lines_is_refused(text, message, tmp_path):
    path = tmp_path / "path.csv"
    path.write_text(text)
    result = run("rv4frl", "--path", path)
    assert isinstance(result.exception, ArmodalError)
    assert message in str(result.exception)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "got neither"),
        ((POSTURE, "--path", "x"), "got both"),
        (("--path", "not there"), "found none; check the path"),
        ((POSTURE, "--modes=6"), "wanted 6 modes in every posture, got 3"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = run("rv4frl", *arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)
