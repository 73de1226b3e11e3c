import json
import re

import pytest
from support.command import armodal
from typer.testing import CliRunner

from armodal.hil_sim.lab import start_laboratory
from armodal.protocols.errors import PlantError, PortError
from armodal.tui.commands.check import app
from armodal.tui.commands.sim import broken_lines

SCALE = "4"


@pytest.fixture(scope="module")
def laboratory(real_time):
    with start_laboratory(time_scale=float(SCALE)) as laboratory:
        yield laboratory


def check(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def test_a_board_check_prints_what_was_wanted_and_what_came(laboratory):
    said = check(
        "board",
        laboratory.board,
        "--time-scale",
        SCALE,
        "--step",
        "dictionary",
        "--step",
        "session",
    )
    assert said.exit_code == 0
    assert "armodal-sim" in said.stdout
    assert re.search("2 pass, 0 fail, 0 not checked", said.stdout)
    assert "Dictionary" in said.stderr
    assert said.stderr.splitlines()[-1] == f"next: armodal run PLAN --board {laboratory.board}"


def test_a_failing_board_is_exit_code_1_and_says_what_to_do(laboratory):
    with broken_lines(laboratory, board="wrong-hash", controller=None) as (board, can):
        assert can == laboratory.can
        said = check("board", board, "--time-scale", SCALE, "--step", "dictionary", "--json")
    assert said.exit_code == 1
    (step,) = json.loads(said.stdout)["steps"]
    assert step["verdict"] == "fail"
    assert "header of HELLO_REPLY" in step["came"]
    assert "CRC-32" in step["hint"]


def test_a_can_check_of_a_lone_controller_says_that_nobody_acknowledges(laboratory):
    with broken_lines(laboratory, board=None, controller="alone") as (_, can):
        said = check("can", can, "--time-scale", SCALE, "--duration", "2", "--json")
    assert said.exit_code == 1
    steps = {step["name"]: step for step in json.loads(said.stdout)["steps"]}
    assert "error-passive" in steps["acknowledged"]["came"]
    assert steps["listening"]["verdict"] == "pass"


def test_a_can_check_of_the_simulated_controller_passes(laboratory):
    said = check(
        "can", laboratory.can, "--time-scale", SCALE, "--duration", "4", "--step", "messages",
        "--step", "scale", "--step", "counter", "--step", "acknowledged",
    )  # fmt: skip
    assert said.exit_code == 0, said.stdout


def test_bad_rates_and_unknown_devices_are_refused(laboratory):
    assert check("board", laboratory.board, "--rate", "fast").exit_code == 2
    assert check("board", laboratory.board, "--rate", "0").exit_code == 2
    assert check("board", laboratory.board, "--duration", "0").exit_code == 2
    with (
        pytest.raises(PlantError, match="broken board there is"),
        broken_lines(laboratory, board="x", controller=None),
    ):
        pass


def test_a_port_that_is_not_there_is_exit_code_2():
    assert isinstance(check("board", "/dev/armodal-none").exception, PortError)
    done = armodal("check", "board", "/dev/armodal-none")
    assert done.returncode == 2
    assert "no such device" in done.stderr.replace("\n", " ")
    assert done.stdout == ""


@pytest.mark.parametrize("command", ["board", "can"])
def test_help_has_an_example(command):
    said = check(command, "--help")
    assert said.exit_code == 0
    assert "Example" in said.stdout
