"""The closed loop: what could hide is asked for, measured, and the ranges shrink."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

import tui.gap_lab
from analyzer.gap.records import NextTest, Verdict
from analyzer.gap.workflow import find_gap
from hil_sim.study import make_case
from protocols.errors import SessionError
from protocols.plan import plan_from_text
from protocols.plan_records import KnownMass
from protocols.plan_rewrite import text_with_posture
from protocols.session.hdf5 import read_session
from tui.cli import app
from tui.gap_lab import SimulatedLaboratory, run_loop


@pytest.fixture(scope="module")
def case():
    return make_case(seed=8, arm="ur5")


@pytest.fixture(scope="module")
def loop(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("loop")
    return folder, run_loop(SimulatedLaboratory(case=case), folder, budget=1, gates=False)


def test_the_test_it_asked_for_is_run_and_told_with_its_reason(loop):
    folder, found = loop
    (test,) = found.tests
    assert test["number"] == 2
    assert "widens k of" in test["why"]
    assert test["gain"] > 0
    plan = read_session(folder / "test-2.h5").header.plan
    assert len(plan.postures) == 1
    names = [row.posture for row in found.outcome.result.gap_after]
    assert any(name.startswith("next test (test 2)") for name in names)


def test_no_stiffness_range_grows_by_far_and_all_hold_the_truth(loop, case):
    _, found = loop
    truth = json.loads(case.open_truth())["joints"]
    for row in found.outcome.result.joint_stiffness_ranges:
        assert row.low < truth[row.joint]["stiffness_n_m_per_rad"] < row.high
    assert found.outcome.result.verdict is Verdict.NOTHING_DETECTABLE


def test_a_known_mass_is_held_out_and_a_right_name_foretells_it():
    case = make_case(seed=3, arm="rv4frl", effect="link_axis", magnitude="clear")
    laboratory = SimulatedLaboratory(case=case)
    first = laboratory.measure(None, 1)
    last = case.arm.joints[-1].link
    body = KnownMass(link=last.name, mass_kg=4.0, center_m=np.asarray(last.center_m))
    posture = replace(case.plan.postures[2], name="loaded", known_mass=body, validation=False)
    text = text_with_posture(case.plan, case.arm, posture, comment="loaded")
    loaded = laboratory.measure(plan_from_text(text, case.arm, origin="loaded"), 2)
    result = find_gap(first, more=[loaded], gates=False, modes=False, advice=False).result
    assert [effect.name for effect in result.effects] == ["link_axis"]
    (before,) = [row for row in result.gap_before if "4.0 kg on" in row.posture]
    (after,) = [row for row in result.gap_after if "4.0 kg on" in row.posture]
    assert before.held_out
    assert after.held_out
    # Clear is three times the true model's error.
    assert after.frf_error < before.frf_error / 3.0


def canned(advice):
    return SimpleNamespace(
        result=SimpleNamespace(verdict=Verdict.AMBIGUOUS, next_test=advice), name="outcome"
    )


class Counting:
    """A laboratory that counts what it is asked."""

    def __init__(self, folder):
        self.session = read_session(folder / "test-1.h5")
        self.further = read_session(folder / "test-2.h5")
        self.arm = self.session.header.arm
        self.numbers = []

    def measure(self, plan, number):
        self.numbers.append(number)
        if plan is None:
            return self.session
        return replace(self.further, header=replace(self.further.header, plan=plan))


def test_a_loop_that_was_stopped_measures_nothing_twice(loop, tmp_path, monkeypatch):
    folder, _ = loop
    text = read_session(folder / "test-2.h5").header.plan.text
    advice = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text)
    monkeypatch.setattr(tui.gap_lab, "find_gap", lambda *_, **__: canned(advice))
    lab = Counting(folder)
    run_loop(lab, tmp_path / "new", budget=0)
    assert lab.numbers == [1]
    again = run_loop(lab, tmp_path / "new", budget=1)
    assert lab.numbers == [1, 2]
    assert [test["number"] for test in again.tests] == [2]
    run_loop(lab, tmp_path / "new", budget=1)
    assert lab.numbers == [1, 2]


def test_a_folder_of_another_test_is_refused(loop, tmp_path, monkeypatch):
    folder, _ = loop
    text = read_session(folder / "test-2.h5").header.plan.text
    lab = Counting(folder)
    first = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text)
    monkeypatch.setattr(tui.gap_lab, "find_gap", lambda *_, **__: canned(first))
    run_loop(lab, tmp_path, budget=1)
    other = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text + "\n# changed\n")
    monkeypatch.setattr(tui.gap_lab, "find_gap", lambda *_, **__: canned(other))
    with pytest.raises(SessionError, match="measured by another plan"):
        run_loop(lab, tmp_path, budget=1)


def test_a_session_and_a_laboratory_at_once_or_neither_are_refused():
    for arguments in (["gap"], ["gap", "some.h5", "--lab"]):
        result = CliRunner().invoke(app, arguments)
        assert isinstance(result.exception, SessionError)
        assert "wanted either a session or --lab" in str(result.exception)
