"""Analysis where devices cannot be run: on Windows, and without pinocchio."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.plain_hits import write_manifest
from support.viper_session import viper_session

from armodal.protocols.session.hdf5 import write_session
from armodal.tui.cli import OF_DEVICES, command_modules

TESTS = Path(__file__).parent
POSTURE = "--posture=0,30,30,0,90,0"


def on_bare_system(*commands, without=(), review=()):
    """Run command lines and open sessions there; return what each told."""
    asked = {
        "without": list(without),
        "commands": [[str(part) for part in command] for command in commands],
        "review": [str(path) for path in review],
    }
    done = subprocess.run(
        [sys.executable, "-P", str(TESTS / "support" / "bare_system.py")],
        input=json.dumps(asked),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": str(TESTS)},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def arm_session(tmp_path_factory):
    folder = tmp_path_factory.mktemp("viper")
    write_session(viper_session(folder), folder / "session.h5")
    return folder / "session.h5"


def analysis_of(manifest, folder):
    """Return the commands that analyse a plain structure."""
    session = folder / "plain.h5"
    return [
        ("import", manifest, "--out", session),
        ("fit", session, "--json"),
        ("export", session, "--out", folder / "plain.uff"),
        ("check", "session", session),
    ]


@pytest.mark.long
def test_an_arm_is_imported_identified_and_reported_without_what_windows_lacks(
    arm_session, tmp_path
):
    commands = [
        *analysis_of(write_manifest(tmp_path), tmp_path),
        ("fit", arm_session, "--json"),
        ("identify", arm_session, "--json"),
        ("report", arm_session, "--out", tmp_path / "report.html"),
    ]
    told = on_bare_system(*commands, review=[tmp_path / "plain.h5"])
    assert [(code, err) for code, _, err in told["commands"] if code] == []
    assert told["review"] == [[2]]
    identified = json.loads(told["commands"][5][1])
    assert len(identified["joints"]) == 5
    assert (tmp_path / "report.html").stat().st_size > 0


@pytest.fixture(scope="module")
def without_pinocchio(arm_session, tmp_path_factory):
    """What a process told without pinocchio, which Windows has not: help, refusals, an analysis."""
    folder = tmp_path_factory.mktemp("plain")
    devices = [*((name,) for name in sorted(OF_DEVICES)), ("check", "board", "COM3")]
    devices.append(("check", "can", "COM4"))
    asked = {
        "help": [("--help",), *((name, "--help") for name in command_modules())],
        "devices": devices,
        "analysis": analysis_of(write_manifest(folder), folder),
        "identify": [("identify", arm_session)],
    }
    every = [command for commands in asked.values() for command in commands]
    told = on_bare_system(*every, without=["pinocchio"], review=[folder / "plain.h5"])
    answers = iter(told["commands"])
    return {
        name: [(command, *next(answers)) for command in commands]
        for name, commands in asked.items()
    } | {"review": told["review"]}


def test_every_command_has_help_there_and_those_of_devices_refuse(without_pinocchio):
    assert [told for told in without_pinocchio["help"] if told[1]] == []
    assert len(without_pinocchio["help"]) == 1 + len(command_modules())
    assert len(without_pinocchio["devices"]) == len(OF_DEVICES) + 2
    for command, code, _, err in without_pinocchio["devices"]:
        assert code == 2, command
        assert "Linux or macOS" in " ".join(err.split()), command


def test_a_plain_structure_is_analysed_without_pinocchio(without_pinocchio):
    assert [told for told in without_pinocchio["analysis"] if told[1]] == []
    assert without_pinocchio["review"] == [[2]]
    [(_, code, _, err)] = without_pinocchio["identify"]
    assert code == 2
    assert "wanted the package pinocchio" in " ".join(err.split())
