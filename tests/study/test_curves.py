"""Learning curves, further tests and the page of a study."""

import json
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import pytest
from support.made_line import MADE_LINE
from support.small_case import SmallCase

import armodal.study.cases
import armodal.study.curves
from armodal.analyzer.gap.next_test.advice import NARROWS
from armodal.hil_sim.study import CaseSpec, make_case
from armodal.study.curves import VARIED, curve_rows, levels_of, reduced, run_curves
from armodal.study.further_tests import nearer_first
from armodal.study.page import study_page
from armodal.study.run import run_case, run_study
from armodal.study.summary import study_summary
from armodal.study.tables import study_tables

small = cache(SmallCase)  # a case is made once


@pytest.fixture(scope="module")
def plan():
    return make_case(1, "ur5").plan


@pytest.mark.parametrize("n", VARIED["postures"])
def test_fewer_postures_keep_one_to_fit_and_one_for_validation(plan, n):
    postures = reduced(plan, "postures", n).postures
    assert len(postures) == n
    assert any(p.validation for p in postures)
    assert any(not p.validation for p in postures)


@pytest.mark.parametrize("n", VARIED["points"])
def test_fewer_points_are_spread_over_the_arm_in_every_posture(plan, n):
    found = reduced(plan, "points", n)
    first, last = plan.postures[0].points[0], plan.postures[0].points[-1]
    for posture in found.postures:
        assert len(posture.points) == n
        assert {first, last} <= set(posture.points)


def test_fewer_hits_are_measured(plan):
    case = make_case(1, "ur5")
    one = reduced(reduced(plan, "hits", 1), "points", 4)
    assert len(case.session(one).hits) == 4 * len(plan.postures)


def test_fewer_hits_of_a_ladder_are_its_middle_then_its_ends():
    spec = CaseSpec(number=1, arm="ur5", seed=3, kinds=(), magnitude="none", ladder=True)
    soft, middle, hard = levels_of(spec, "hits", 3)
    assert soft < middle < hard
    assert levels_of(spec, "hits", 1) == (middle,)
    assert levels_of(spec, "hits", 2) == (soft, hard)
    assert levels_of(spec, "points", 4) is None
    assert levels_of(replace(spec, ladder=False), "hits", 1) is None


def test_curves_are_kept_and_not_judged_twice(tmp_path, monkeypatch):
    spec = CaseSpec(number=3, arm="ur5", seed=12, kinds=("delay",), magnitude="clear", ladder=False)
    monkeypatch.setattr(armodal.study.cases, "sealed", small)
    # Too few points are refused before anything is fitted: quick, and a line of the curve.
    monkeypatch.setattr(armodal.study.curves, "VARIED", {"points": (3,)})
    told: list[str] = []
    with ThreadPoolExecutor(1) as executor:
        hashes = {3: small(spec).truth_sha256}
        lines = run_curves([spec], hashes, tmp_path / "curves.jsonl", executor, told.append)
        again = run_curves([spec], hashes, tmp_path / "curves.jsonl", executor, told.append)
    assert told == ["case 3, 3 points: refused"]
    assert again == lines
    (row,) = curve_rows(lines)
    assert (row["varied"], row["n"], row["cases"], row["right"]) == ("points", 3, 1, 0)
    assert row["k_range"] is None


@pytest.mark.long
def test_a_curve_of_another_truth_or_of_none_is_judged_again(tmp_path, monkeypatch):
    monkeypatch.setattr(armodal.study.cases, "sealed", small)
    spec = CaseSpec(number=3, arm="ur5", seed=12, kinds=("delay",), magnitude="clear")
    other = replace(spec, kinds=("hammer_gain",))  # as `--whole` draws it: the same number and seed
    monkeypatch.setattr(armodal.study.curves, "VARIED", {"points": (3,)})
    path = tmp_path / "curves.jsonl"
    told: list[str] = []
    with ThreadPoolExecutor(1) as executor:
        for case in (spec, other, spec):
            hashes = {3: small(case).truth_sha256}
            (row,) = run_curves([case], hashes, path, executor, told.append)
            assert row["truth_sha256"] == hashes[3]
        assert len(told) == 2  # the third is kept from the first
        row.pop("truth_sha256")
        path.write_text(json.dumps(row) + "\n")
        run_curves([spec], hashes, path, executor, told.append)
    assert len(told) == 3


def test_a_size_that_rests_at_zero_has_no_relative_scatter(tmp_path, monkeypatch):
    monkeypatch.setattr(armodal.study.cases, "sealed", small)

    def effect(value, std):
        return SimpleNamespace(
            size="s", gain=1.0, parameters={"s": SimpleNamespace(value=value, std=std)}
        )

    def found(*effects):
        joint = SimpleNamespace(low=1.0, high=2.0)
        result = SimpleNamespace(joint_stiffness_ranges=(joint,), effects=effects)
        monkeypatch.setattr(
            armodal.study.curves, "find_gap", lambda *_, **__: SimpleNamespace(result=result)
        )
        with ThreadPoolExecutor(1) as executor:
            path = tmp_path / f"{len(effects)}.jsonl"
            return run_curves([spec], hashes, path, executor)[0]["size_std"]

    spec = CaseSpec(number=3, arm="ur5", seed=12, kinds=("delay",), magnitude="clear")
    hashes = {3: small(spec).truth_sha256}
    monkeypatch.setattr(armodal.study.curves, "VARIED", {"hits": (1,)})
    monkeypatch.setattr(armodal.study.curves, "mark", lambda *_: SimpleNamespace(outcome="right"))
    assert found(effect(0.0, 0.1), effect(-2.0, 0.5)) == 0.25
    assert found(effect(0.0, 0.1)) is None


@pytest.mark.long
def test_while_nothing_is_named_the_workflow_s_test_is_measured_beside_random_ones(monkeypatch):
    """Of a payload far too small to be seen."""
    spec = CaseSpec(number=1, arm="ur5", seed=21, kinds=("payload",), magnitude=0.05, ladder=False)
    monkeypatch.setattr(armodal.study.cases, "sealed", small)
    line = run_case(spec, tests=1)
    assert line.keys() == MADE_LINE.keys()
    assert line["outcome"] == "missed"
    assert line["tests"] == 1
    (after,) = line["after"]
    assert after["words"].startswith("measure all points")
    assert after["verdict"] in ("nothing_detectable", "ambiguous", "named")
    assert after["outcome"] != "wrong name"
    assert all(width > 0.0 for width in line["widths"].values())


def test_evidence_counts_for_the_compared_model_that_is_nearer_to_the_truth():
    def model(*keys):
        instances = [SimpleNamespace(key=key) for key in keys]
        return SimpleNamespace(hypothesis=SimpleNamespace(instances=instances))

    slip, loss = ("friction", "a"), ("hysteretic", "b")
    plain, rubbing, wrong = model(), model(slip), model(loss)
    assert nearer_first([plain, rubbing], [slip]) == (rubbing, plain)
    assert nearer_first([plain, wrong], [slip]) == (plain, wrong)
    assert nearer_first([wrong, rubbing, plain], [slip]) == (rubbing, wrong)
    assert nearer_first([plain, wrong], []) == (plain, wrong)  # nothing was hidden
    assert nearer_first([wrong, model(loss, slip)], [slip]) is None
    assert nearer_first([plain, wrong], [None]) is None


def test_what_a_test_gained_is_counted_in_what_it_was_asked_for():
    widths = {"before": 0.4, "asked": 0.1, "random": 0.3}
    (row,) = MADE_LINE["after"]
    narrows = MADE_LINE | {
        "number": 2,
        "after": [row | {"why": f"shows whether a servo hides, {NARROWS} j1"}],
        "brought": {},
        "widths": widths,
    }
    tells = MADE_LINE | {
        "number": 3,
        "after": [row | {"why": "tells apart: a, or b"}],
        "widths": widths,
    }
    told = [
        tells | {"number": 3 + i, "brought": {"asked": asked, "random": [1.0, 3.0]}}
        for i, asked in enumerate((12.0, 3.0, -1.0))
    ]
    tests = study_summary([narrows, *told])["tests"]
    assert tests["compared"] == 3
    assert (tests["brought_asked"], tests["brought_random"]) == (3.0, 2.0)
    assert tests["brought_in_all"] == [14.0, 6.0]
    assert (tests["brought_twice"]["k"], tests["brought_twice"]["n"]) == (1, 3)
    assert tests["widths"] == {"n": 1, **widths}


class Asked(Executor):
    """Runs nothing, keeps how many further tests each case may have."""

    def __init__(self):
        self.tests = {}

    def submit(self, fn, /, spec, tests):
        self.tests[spec.number] = tests
        done = Future()
        done.set_result({"number": spec.number, "truth_sha256": "", "error": "not run"})
        return done


def test_every_hidden_effect_and_each_fifth_null_may_ask_for_tests(tmp_path):
    specs = [
        CaseSpec(number=n, arm="ur5", seed=n, kinds=kinds, magnitude="clear" if kinds else "none")
        for n, kinds in enumerate([()] * 10 + [("delay",)] * 3, start=1)
    ]
    asked = Asked()
    run_study(specs, {}, tmp_path / "study.jsonl", asked, tests=2)
    assert {n for n, tests in asked.tests.items() if tests == 2} == {5, 10, 11, 12, 13}
    assert {n for n, tests in asked.tests.items() if tests == 0} == {1, 2, 3, 4, 6, 7, 8, 9}


def test_the_page_has_every_table():
    summary = study_summary([MADE_LINE | {"magnitude": "faint"}])
    assert summary["tests"]["n"] == 1
    rows = [
        {"varied": "hits", "n": 1, "cases": 2, "right": 1, "wrong": 0}
        | {"size_std": 0.02, "k_range": None, "gain": 120.0}
    ]
    page = study_page(study_tables(summary, rows), "armodal gap-study --out study --seed 1")
    assert "    armodal gap-study --out study --seed 1" in page
    assert "| faint | 1 | 0 |" in page
    assert "| payload | nothing_detectable 1 |" in page
    assert "| hits | 1 | 2 | 1 | 0 | 120 | 2.0 % | - |" in page
