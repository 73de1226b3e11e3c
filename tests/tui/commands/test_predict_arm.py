"""`armodal predict --arm`."""

from __future__ import annotations

import json

import pytest
from support.added import axis
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmodalError
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
