"""The last line of a command says which one comes next, and stdout keeps to the data."""

from __future__ import annotations

import json
from importlib import import_module

import numpy as np
import pytest
from rich.table import Table
from support.added import axis
from support.command import armodal
from support.foreign_samples import accelerance
from support.foreign_writers import signalcalc

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.rewrite import text_with_effects

POSTURE = "--posture=0,30,30,0,90,0"


def next_of(*arguments: object, code: int = 0) -> str:
    said = armodal(*arguments)
    assert said.returncode == code, said.stderr
    assert "next: " not in said.stdout
    return said.stderr.splitlines()[-1]


@pytest.fixture
def corrected(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(text_with_effects(load_arm("rv4frl"), [axis("shoulder")]), encoding="utf-8")
    return path


@pytest.fixture
def measured(tmp_path):
    """Three FRF files of another program."""
    freq_hz = 0.25 * np.arange(1, 401)
    names = [tmp_path / f"H{i + 1:05d}.txt" for i in range(3)]
    for i, name in enumerate(names):
        name.write_bytes(signalcalc(freq_hz, accelerance(freq_hz, i, 0)))
    return names


def test_predict_of_an_arm_leads_to_shapers_for_the_same_posture(corrected):
    line = next_of("predict", "--arm", corrected, POSTURE)
    assert line.startswith(f"next: armodal shaper {corrected} {POSTURE} ")
    as_told = line.removeprefix("next: armodal ").split("   ")[0].split()
    assert armodal(*as_told, "--json").returncode == 0  # what is advised works


def test_the_workspace_leads_to_a_plan_and_a_load_to_the_workspace(tmp_path):
    folder = tmp_path / "w"
    line = next_of("workspace", "viper_s650", "--postures", "200", "--out", folder)
    assert line.startswith("next: armodal plan viper_s650 ")
    load = ("--wrench", "0,50,-100,0,0,0", "--at", "0,0,0.1")
    for where in (("--posture", "0,0,60,0,40,0"), ("--rank", "20")):
        line = next_of("mozzi", "viper_s650", *where, *load)
        assert line.startswith("next: armodal workspace viper_s650 ")


def test_inspect_leads_to_the_import_and_export_to_the_report(measured, tmp_path):
    line = next_of("inspect", *measured)
    assert line.startswith("next: armodal import ")
    session = tmp_path / "own.h5"
    assert armodal("import", *measured, "--out", session).returncode == 0
    line = next_of("export", session, "--no-modes", "--out", tmp_path / "own.uff")
    assert line == f"next: armodal report {session}"


def test_an_exported_arm_leads_to_what_the_simulator_must_reproduce(corrected, tmp_path):
    line = next_of("export", corrected, "--urdf", tmp_path / "arm.urdf")
    assert line.startswith(f"next: armodal predict --arm {corrected} --posture=DEG")


@pytest.mark.parametrize(("fault", "code", "command"), [(None, 0, "fit"), ("gain", 1, "review")])
def test_a_checked_session_is_fitted_or_looked_at(monkeypatch, fault, code, command):
    check = import_module("armodal.tui.commands.check")
    monkeypatch.setattr(check, "read_session", lambda path: path)
    monkeypatch.setattr(
        check, "session_checks", lambda _: ({"checks": [{"fault": fault}]}, Table())
    )
    line = next_of("check", "session", "s.h5", code=code)
    assert line == f"next: armodal {command} s.h5"
    said = armodal("check", "session", "s.h5", "--json")
    assert json.loads(said.stdout)["checks"] == [{"fault": fault}]


def test_the_papers_lead_to_the_demo(monkeypatch):
    reproduce = import_module("armodal.tui.commands.reproduce")
    monkeypatch.setattr(reproduce, "reproduce_papers", lambda *_: ([], []))
    assert next_of("reproduce").startswith("next: armodal demo ")
