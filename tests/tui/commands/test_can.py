"""`armodal can learn`: a dialogue with the pendant, files, and a check."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.chain_arm import chain_arm_text
from typer.testing import CliRunner

import armodal.tui.commands.can
from armodal.hil_sim.joint_messages import JointMessages
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.generic_can import generic_mapping
from armodal.protocols.errors import SessionError
from armodal.protocols.slcan import SlcanParser
from armodal.tui.cli import app

START, CHECK = [10.0, -30.0], [-50.0, -80.0]
STOPS = [START, [45.0, -30.0], [-45.0, -30.0], [-45.0, -60.0], [-45.0, -10.0], CHECK]


class StandingBus:
    """A bus that tells the posture of the stop; nothing could be sent on it."""

    confirmed_silent = True

    def __init__(self, lie_deg=0.0):
        names = ["axis 1", "axis 2"]
        self.messages = JointMessages(generic_mapping(names), names)
        self.stop, self.lie_deg, self.cycle = -1, lie_deg, 0

    def hear(self, *_):
        self.stop += 1
        truth = np.radians(STOPS[self.stop])
        if self.stop == len(STOPS) - 1:
            truth = truth + np.radians(self.lie_deg)
        frames = []
        for _ in range(10):
            self.cycle += 1
            lines = self.messages.lines(truth.tolist(), moving=False, counter=self.cycle)
            frames += SlcanParser().feed(lines)
        return tuple(frames)

    def close(self):
        self.closed = True


@pytest.fixture
def learn(tmp_path, monkeypatch):
    (tmp_path / "two.toml").write_text(chain_arm_text(2, name="two"), encoding="utf-8")

    def run(bus, *, lines=None):
        monkeypatch.setattr(armodal.tui.commands.can, "open_can", lambda *_: bus)
        monkeypatch.setattr(armodal.tui.commands.can, "_heard", bus.hear)
        typed = lines or ["10.0 -30.0", "45.0", "-45.0", "-60.0", "-10.0", "-50.0, -80.0"]
        arguments = ["can", "learn", "there", "--arm", str(tmp_path / "two.toml"), "--json"]
        arguments += ["--out", str(tmp_path / "learned")]
        return CliRunner().invoke(app, arguments, input="\n".join(typed) + "\n")

    return run


def test_the_learned_section_makes_the_arm_file_one_with_a_bus(learn, tmp_path):
    bus = StandingBus()
    result = learn(bus)
    assert result.exit_code == 0, result.output
    assert bus.closed
    found = json.loads(result.stdout[result.stdout.index("{") :])
    assert [joint["factor_deg"] for joint in found["joints"]] == [1e-4, 1e-4]
    assert [round(j["bus_minus_pendant_deg"], 6) for j in found["joints"]] == [0.0, 0.0]
    folder = tmp_path / "learned"
    section = (folder / "two.can.toml").read_text(encoding="utf-8")
    whole = (tmp_path / "two.toml").read_text(encoding="utf-8") + "\n" + section
    (folder / "whole.toml").write_text(whole, encoding="utf-8")
    arm = load_arm(folder / "whole.toml")
    assert [signal.joint for signal in arm.can.joints] == ["axis 1", "axis 2"]
    assert arm.can.counter is not None


def test_a_bus_that_says_other_angles_than_the_pendant_is_told(learn):
    result = learn(StandingBus(lie_deg=1.0))
    assert result.exit_code == 1
    assert "axis 1, axis 2: pendant and bus disagree" in result.stderr


def test_what_is_no_angle_or_no_move_is_asked_for_again(learn):
    lines = ["10", "x y", "10.0 -30.0", "11.0", "nan", "45.0", "-45.0", "-60.0", "-10.0"]
    result = learn(StandingBus(), lines=[*lines, "-50.0 -80.0"])
    assert result.exit_code == 0, result.output
    assert "wanted 2 numbers" in result.stderr
    assert "wanted one number at least 5 from 10" in result.stderr


def test_files_that_are_there_are_not_replaced(learn, tmp_path):
    (tmp_path / "learned").mkdir()
    (tmp_path / "learned" / "two.dbc").write_text("mine", encoding="utf-8")
    result = learn(StandingBus())
    assert isinstance(result.exception, SessionError)
    assert "not replaced" in str(result.exception)
    assert (tmp_path / "learned" / "two.dbc").read_text(encoding="utf-8") == "mine"
