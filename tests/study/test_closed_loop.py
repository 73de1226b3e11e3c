"""The closed loop: what could hide is asked for, measured, and the ranges shrink."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.small_case import small_case

import armodal.study.closed_loop
from armodal.analyzer.gap.records import NextTest, Verdict
from armodal.protocols.errors import SessionError
from armodal.protocols.plan_rewrite import text_with_posture
from armodal.protocols.session.hdf5 import read_session
from armodal.study.closed_loop import run_loop
from armodal.study.laboratory import SimulatedLaboratory


@pytest.fixture(scope="module")
def case():
    return small_case(8, "ur5")


@pytest.fixture(scope="module")
def judged(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("judged")
    return folder, run_loop(SimulatedLaboratory(case=case), folder, budget=1, gates=False)


@pytest.mark.long
def test_the_test_that_the_workflow_asks_for_is_run_and_judged(judged):
    folder, found = judged
    (test,) = found.tests
    assert test["number"] == 2
    assert test["gain"] > 0
    plan = read_session(folder / "test-2.h5").header.plan
    assert plan.text.startswith(f"# Proposed: {test['why']}\n")
    assert len(plan.postures) == 1
    names = [row.posture for row in found.outcome.result.gap_after]
    assert any(name.startswith("next test (test 2)") for name in names)


@pytest.mark.long
def test_no_stiffness_range_grows_by_far_and_all_hold_the_truth(judged, case):
    _, found = judged
    truth = json.loads(case.open_truth())["joints"]
    for row in found.outcome.result.joint_stiffness_ranges:
        assert row.low < truth[row.joint]["stiffness_n_m_per_rad"] < row.high
    assert found.outcome.result.verdict is Verdict.NOTHING_DETECTABLE


def canned(advice):
    return SimpleNamespace(
        result=SimpleNamespace(verdict=Verdict.AMBIGUOUS, next_test=advice), name="outcome"
    )


@pytest.fixture(scope="module")
def loop(case, tmp_path_factory):
    """Two tests; the second asked for by a canned judgement."""
    folder = tmp_path_factory.mktemp("loop")
    posture = replace(case.plan.postures[0], name="next test")
    text = text_with_posture(case.plan, case.arm, posture, comment="Proposed: tells")
    advice = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: canned(advice))
        return folder, run_loop(SimulatedLaboratory(case=case), folder, budget=1)


def test_the_test_asked_for_is_run_by_its_plan_and_told_with_its_reason(loop, case):
    folder, found = loop
    (test,) = found.tests
    assert test == {
        "number": 2,
        "words": "measure",
        "why": "tells",
        "gain": 9.0,
        "verdict_before": "ambiguous",
        "verdict_after": "ambiguous",
    }
    first, second = (read_session(folder / f"test-{number}.h5") for number in (1, 2))
    assert first.header.plan.sha256 == case.plan.sha256
    assert {hit.posture for hit in second.hits} == {"next test"}


class Counting:
    """A laboratory that counts what it is asked."""

    def __init__(self, folder):
        self.session = read_session(folder / "test-1.h5")
        self.further = read_session(folder / "test-2.h5")
        self.arm = self.session.header.arm
        self.identity = "the only one"
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
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: canned(advice))
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
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: canned(first))
    run_loop(lab, tmp_path, budget=1)
    other = NextTest(words="measure", why="tells", gain=9.0, plan_toml=text + "\n# changed\n")
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: canned(other))
    with pytest.raises(SessionError, match="measured by another plan"):
        run_loop(lab, tmp_path, budget=1)


def test_a_folder_of_another_laboratory_is_refused_before_anything_is_measured(
    loop, tmp_path, monkeypatch
):
    folder, _ = loop
    monkeypatch.setattr(armodal.study.closed_loop, "find_gap", lambda *_, **__: canned(None))
    one, other = Counting(folder), Counting(folder)
    run_loop(one, tmp_path, budget=0)
    other.identity = "another"
    with pytest.raises(SessionError, match="wanted another, got the only one"):
        run_loop(other, tmp_path, budget=0)
    (tmp_path / "laboratory").unlink()
    with pytest.raises(SessionError, match="got one that is not told"):
        run_loop(one, tmp_path, budget=0)
    assert (one.numbers, other.numbers) == ([1], [])
