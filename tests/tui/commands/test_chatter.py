"""`armodal chatter`."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from armodal.analyzer.acting import chatter
from armodal.protocols.errors import ArmodalError
from armodal.tui.cli import app

ONE = ("rv4frl", "--posture=0,30,60,0,60,0", "--kt=600", "--kr=200")


def run(*arguments):
    return CliRunner().invoke(app, ["chatter", *map(str, arguments)])


def test_lobes_are_told_for_people_and_machines(tmp_path, monkeypatch):
    monkeypatch.setattr(chatter, "_DRAWS", 6)
    monkeypatch.setattr(chatter, "_STEPS", 30)
    html = tmp_path / "chat.html"
    arguments = (*ONE, "--speeds=1500,6000,20", "--html", html)
    value = json.loads(run(*arguments, "--json").stdout)
    assert len(value["depth_m"]) == 20
    band = zip(value["depth_low_m"], value["depth_high_m"], strict=True)
    assert all(low is None or low <= high for low, high in band)
    assert len(value["semi_discretisation"]) == 3
    assert "Stability lobes at the tool of rv4frl" in html.read_text()
    assert "stable at any speed" in run(*arguments).stdout


def test_several_postures_are_a_map_over_feeds():
    arguments = (*ONE, "--posture=0,20,80,0,60,0", "--directions=4")
    value = json.loads(run(*arguments, "--json").stdout)
    assert [len(row) for row in value["always_m"]] == [4, 4]
    assert "best feed" in run(*arguments).stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("rv4frl", "--kt=600"), "got neither"),
        ((*ONE, "--immersion=0"), "immersion above 0"),
        ((*ONE, "--speeds=9,1,5"), "--speeds: wanted low below high"),
        ((*ONE, "--feed=0,0,1"), "got one along it"),
        ((*ONE, "--posture=0,20,80,0,60,0", "--html=x.html"), "--html: wanted one posture"),
    ],
)
def test_a_user_s_mistake_is_one_message(arguments, message):
    result = run(*arguments)
    assert isinstance(result.exception, ArmodalError), result.output
    assert message in str(result.exception)
