import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.acquired_here import start_here
from support.at_the_end import at_the_end
from support.command import armodal
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.hdf5 import read_session
from armodal.tui import commands, operators
from armodal.tui.cli import app, command_modules

SMALL_PLAN = """
format = "armodal-plan-1"
name = "two-points"
arm = "rv4frl"
mode = "roving-response"
fixed_point = "1"
hits_per_point = 2
max_attempts = 20
[sampling]
rate_hz = "51200/31"
samples = 2048
pretrigger = 100
[trigger]
level_n = 8.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "test 1"
joints_deg = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
tolerance_deg = 0.5
points = ["1", "5"]
hit_direction = [-0.383, -0.821, 0.423]
"""


def process(*arguments, timeout=120):
    return subprocess.run(
        [sys.executable, "-m", "armodal.tui.cli", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


@pytest.mark.parametrize("command", command_modules())
def test_every_command_has_help_with_an_example(command):
    said = armodal(command, "--help")
    assert said.returncode == 0
    assert "Example" in said.stdout
    assert "completion" not in said.stdout


@pytest.mark.parametrize(
    ("typed", "wanted"), [("armodal ident", "identify"), ("armodal devices --js", "--json")]
)
def test_a_shell_completes_commands_and_options(monkeypatch, typed, wanted):
    monkeypatch.setenv("_ARMODAL_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(typed.count(" ")))
    said = armodal()
    assert said.returncode == 0
    assert said.stdout.split() == [wanted]


def test_a_command_that_is_mistyped_is_told_the_one_that_was_meant():
    said = process("identfy")
    assert said.returncode == 2
    assert "Did you mean 'identify'" in said.stderr


@pytest.mark.parametrize("before", [[], ["inspect"], ["inspect", "a.csv"], ["arm"]])
def test_an_argument_that_is_no_option_does_not_steer_the_terminal(before):
    """`*` in a shell puts names of files there."""
    found = CliRunner().invoke(app, [*before, "--a\x1b[2J\x9b2J\u202egnp"])
    assert found.exit_code == 2
    assert "\\u202egnp" in found.output
    for sign in "\x1b\x9b\u202e":
        assert sign not in found.output


def test_the_help_lists_every_command_of_every_module():
    said = armodal("--help")
    assert said.returncode == 0
    for name in command_modules():
        assert re.search(rf"^. {name} ", said.stdout, re.MULTILINE), name


def test_a_command_is_a_module_that_is_found(tmp_path, monkeypatch):
    text = "import typer\napp = typer.Typer()\n\n@app.command()\ndef wave():\n    print('waved')\n"
    (tmp_path / "wave_on.py").write_text(text, encoding="utf-8")
    monkeypatch.setattr(commands, "__path__", [*commands.__path__, str(tmp_path)])
    command_modules.cache_clear()
    try:
        assert list(command_modules())[-1] == "wave-on"  # behind those whose place is told
        said = CliRunner().invoke(app, ["wave-on"])
        assert (said.exit_code, said.output) == (0, "waved\n")
    finally:
        command_modules.cache_clear()
        sys.modules.pop("armodal.tui.commands.wave_on", None)


@pytest.mark.parametrize("command", ["fit", "identify", "report", "recover"])
def test_a_file_that_is_not_a_session_is_one_message_and_exit_code_2(command, tmp_path):
    path = tmp_path / "not-a-session.h5"
    path.write_bytes(b"hello")
    said = armodal(command, path)
    assert said.returncode == 2
    assert "Traceback" not in said.stderr
    assert "armodal:" in said.stderr
    assert list(tmp_path.iterdir()) == [path]  # nothing half written


def test_a_wrong_port_is_one_message_and_exit_code_2(tmp_path):
    said = armodal(
        "acquire",
        "rv4frl-three-postures",
        "--board",
        tmp_path / "no-port",
        "--can",
        tmp_path / "no-can",
        "--journal",
        tmp_path / "s.journal",
        "--operator",
        tmp_path / "none",
    )
    assert said.returncode == 2
    assert "Traceback" not in said.stderr


def test_a_small_session_runs_from_hits_to_a_session_file(tmp_path, real_time, monkeypatch):
    monkeypatch.setattr(operators, "start_process", start_here)
    plan = tmp_path / "small.toml"
    plan.write_text(SMALL_PLAN)
    # At 8 lab seconds a second the session takes a few seconds.
    lab = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "armodal.tui.cli",
            "sim",
            "--json",
            "--time-scale",
            "8",
            "--out",
            str(tmp_path / "lab"),
        ],
        stdout=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
    )
    with at_the_end(f"kill {lab.pid}"):
        ports = json.loads(lab.stdout.readline())
        said = armodal(
            "acquire",
            plan,
            "--board",
            ports["board"],
            "--can",
            ports["can"],
            "--operator",
            ports["operator"],
            "--time-scale",
            "8",
            "--journal",
            tmp_path / "s.journal",
            "--json",
        )
    lab.wait(20)
    lab.stdout.close()
    assert said.returncode == 0, said.stderr
    summary = json.loads(said.stdout)
    assert summary["complete"]
    session = read_session(Path(summary["session"]))
    arm = load_arm("rv4frl")
    points = load_plan(plan, arm).postures[0].points
    for point in points:
        good = [hit for hit in session.accepted() if hit.sensor_point == point]
        assert len(good) == 2
