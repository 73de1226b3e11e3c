"""One case of a study: what its line holds when the search for the gap comes to a given end."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.gap_results import made_result
from support.made_line import MADE_LINE
from support.small_case import SmallCase

import armodal.study.cases
import armodal.study.run
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import PostureGap, StiffnessRange
from armodal.hil_sim.study import CaseSpec
from armodal.protocols.errors import EstimateError
from armodal.study.run import run_case
from armodal.study.score import instance_of_truth

SPEC = CaseSpec(number=4, arm="ur5", seed=8, kinds=(), magnitude="none")
HIDDEN = replace(SPEC, kinds=("delay",), magnitude="clear")


class Unmeasured(SmallCase):
    """Nothing looks at its session here."""

    def session(self, *_, **__):
        return None


def gaps(*errors):
    """Of a posture to learn from and one held out."""
    return tuple(
        PostureGap(posture=f"test {i}", held_out=bool(i), frf_error=error, floor=0.01)
        for i, error in enumerate(errors)
    )


RANGE = StiffnessRange(joint="shoulder_pan", k_n_m_per_rad=1e5, k_std=2e3, low=9e4, high=1.2e5)


@pytest.fixture
def line_of(monkeypatch):
    """The line of a case whose search ends as told."""

    def of(spec, named, instances=()):
        case = Unmeasured(spec)
        ordinary = Ordinary(superset=Superset(case.arm), postures=("p",))
        result = replace(
            made_result("named" if named else "nothing_detectable", named),
            gap_before=gaps(0.5, 0.3),
            gap_after=gaps(0.2, 0.1),
            joint_stiffness_ranges=(RANGE,),
        )
        hypothesis = Hypothesis(ordinary=ordinary, instances=tuple(instances))
        outcome = SimpleNamespace(
            result=result, final=SimpleNamespace(hypothesis=hypothesis), stages=()
        )
        monkeypatch.setattr(armodal.study.cases, "sealed", lambda spec: case)
        monkeypatch.setattr(armodal.study.run, "find_gap", lambda *_, **__: outcome)
        return run_case(spec), json.loads(case.open_truth())

    return of


def test_a_case_that_hides_nothing_and_gets_no_name_is_right_and_as_good_as_the_truth(line_of):
    line, truth = line_of(SPEC, [])
    assert line.keys() == MADE_LINE.keys() - {"after", "brought", "widths"}
    assert (line["number"], line["outcome"], line["true"]) == (4, "right", ())
    # Nothing to fit beside: the model that was found is the true one.
    assert line["over_true_model"] == 1.0
    assert line["stands_out"] == pytest.approx(3.0)  # of the posture held out alone
    (row,) = line["stiffness"]
    assert row["true"] == truth["joints"][RANGE.joint]["stiffness_n_m_per_rad"]
    assert (row["k"], row["low"], row["high"]) == (1e5, 9e4, 1.2e5)


def test_a_name_where_nothing_is_hidden_is_a_wrong_one(line_of):
    line, _ = line_of(SPEC, ["payload"])
    assert (line["outcome"], line["named"]) == ("wrong name", ("payload",))
    assert line["sizes"] == []


def test_a_true_model_is_not_fitted_again_where_it_was_found(line_of, monkeypatch):
    def never(*_, **__):
        raise AssertionError("fitted")

    monkeypatch.setattr(armodal.study.run, "fit_hypothesis", never)
    case = Unmeasured(HIDDEN)
    ordinary = Ordinary(superset=Superset(case.arm), postures=("p",))
    (true,) = json.loads(case.open_truth())["effects"]
    own = instance_of_truth(ordinary, true)
    assert own is not None
    line, _ = line_of(HIDDEN, ["delay"], [own])
    assert line["over_true_model"] == 1.0
    (row,) = line["sizes"]
    assert (row["name"], row["found"]) == ("delay", 1.0)


def test_a_case_that_is_refused_has_a_line_that_says_why(monkeypatch):
    def refuse(*_, **__):
        raise EstimateError("two postures wanted")

    case = Unmeasured(SPEC)
    monkeypatch.setattr(armodal.study.cases, "sealed", lambda spec: case)
    monkeypatch.setattr(armodal.study.run, "find_gap", refuse)
    assert run_case(SPEC, tests=2) == {
        "number": 4,
        "error": "two postures wanted",
        "truth_sha256": case.truth_sha256,
        "arm": "ur5",
        "tests": 2,
    }
