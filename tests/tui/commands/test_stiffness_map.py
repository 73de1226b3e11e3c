"""`armodal stiffness-map`."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.computed_once import computed_once
from typer.testing import CliRunner

from armodal.protocols.errors import ArmodalError
from armodal.tui.cli import app
from armodal.tui.commands import stiffness_map


def run(*arguments):
    return CliRunner().invoke(app, ["stiffness-map", *map(str, arguments)])


def test_a_path_becomes_a_table_a_page_and_an_object(tmp_path):
    path, csv, html = (tmp_path / name for name in ("p.csv", "s.csv", "s.html"))
    path.write_text("0,20,80,0,60,0\n0,40,60,0,60,0\n")
    arguments = ("rv4frl", "--path", path, "--force=0,0,-100", "--csv", csv, "--html", html)
    value = json.loads(run(*arguments, "--json").stdout)
    assert len(value["stiffness_along_n_per_m"]) == 2
    assert value["best_posture_deg"] in value["postures_deg"]
    assert len(csv.read_text().splitlines()) == 3
    assert "Stiffness at the tool of rv4frl" in html.read_text()
    assert "stiffest at" in run(*arguments).stdout


def test_the_plane_names_an_elbow_for_every_place():
    value = json.loads(run("viper_s650", "--plane", "--force=0,0,-100", "--json").stdout)
    assert set(value["elbow"]) <= {"up", "down"}
    assert len(value["elbow"]) == len(value["postures_deg"]) > 1000


@pytest.mark.parametrize("lines", [1, pytest.param(2, marks=pytest.mark.long)])
def test_the_best_angle_of_a_tool_that_may_turn_is_told_beside_the_given_one(
    tmp_path, monkeypatch, lines
):
    monkeypatch.setattr(
        stiffness_map, "stiffest_angle", computed_once(stiffness_map.stiffest_angle)
    )
    path, html = tmp_path / "p.csv", tmp_path / "s.html"
    path.write_text("0,-60,160,20,50,0\n10,-40,140,0,60,0\n"[: 18 * lines])
    arguments = (
        "viper_s650",
        "--path",
        path,
        "--force=30,0,-100",
        "--at=0.1,0,0.1",
        "--spin=1,0,0",
    )
    value = json.loads(run(*arguments, "--html", html, "--json").stdout)
    alone, together, given = (
        np.array(own["stiffness_along_n_per_m"])
        for own in (
            value["each_alone"],
            value,
            {"stiffness_along_n_per_m": value["given_stiffness_along_n_per_m"]},
        )
    )
    assert (alone >= given).all()
    assert np.sum(1.0 / alone) <= np.sum(1.0 / together) <= np.sum(1.0 / given)
    assert len(value["free_angle_deg"]) == lines
    assert "over its free angle" in html.read_text()
    assert "times as stiff as in the given postures" in " ".join(run(*arguments).stdout.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--force=0,0,1",), "got neither"),
        (("--force=0,0,0", "--plane"), "wanted a force, got none"),
        (("--force=0,0", "--plane"), "--force: wanted 3 numbers"),
        (("--force=0,0,1", "--path=not there"), "found none; check the path"),
        (("--force=0,0,1", "--plane", "--free-angle"), "give a path"),
        (("--force=0,0,1", "--path=p", "--free-angle", "--spin=1,0,0"), "got both"),
        (("--force=0,0,1", "--path=p", "--spin=0,0,0"), "the direction of an axis"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = run("viper_s650", *arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)
