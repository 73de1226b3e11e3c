"""What further tests bring to a case whose search for the gap comes to given ends."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.gap_results import made_result
from support.small_case import small_case

import armodal.study.further_tests
from armodal.analyzer.gap.next_test.advice import NARROWS
from armodal.analyzer.gap.next_test.possible_tests import Test
from armodal.analyzer.gap.records import NextTest, StiffnessRange
from armodal.protocols.plan_rewrite import text_with_posture
from armodal.study.further_tests import further

TRUTH = {"effects": [], "verdict": "nothing_detectable"}


@pytest.fixture(scope="module")
def case():
    return small_case(8, "ur5")


@pytest.fixture(scope="module")
def session(case):
    return case.session()


def told(case, verdict, half_width):
    """An outcome with one joint's range, and advice to measure the first posture again."""
    posture = replace(case.plan.postures[0], name="next test")
    text = text_with_posture(case.plan, case.arm, posture, comment="asked for")
    advice = NextTest(words="measure", why=f"{NARROWS} elbow", gain=2.0, plan_toml=text)
    row = StiffnessRange(
        joint="elbow",
        k_n_m_per_rad=1e5,
        k_std=1e3,
        low=1e5 * np.exp(-half_width),
        high=1e5 * np.exp(half_width),
    )
    named = ["payload"] if verdict == "named" else []
    result = replace(made_result(verdict, named), joint_stiffness_ranges=(row,), next_test=advice)
    return SimpleNamespace(result=result, stages=(None,), final=None)


@pytest.fixture
def ends(monkeypatch, case):
    """Give the ends of later searches, in order; notes what each was given and what was random."""
    seen = []

    def begin(*outcomes):
        left = list(outcomes)

        def find(first, *, more, **_):
            seen.append([test.header.plan.postures[0].name for test in more])
            return left.pop(0)

        monkeypatch.setattr(armodal.study.further_tests, "find_gap", find)
        plain = case.plan.postures[0]
        random = Test(joints_rad=plain.joints_rad, hit_direction=plain.hit_direction)
        monkeypatch.setattr(
            armodal.study.further_tests, "possible_tests", lambda *_, **__: [random]
        )
        return seen

    return begin


def test_nothing_is_measured_once_something_is_named(case, session, ends):
    seen = ends()
    found = further(case, session, told(case, "named", 0.1), TRUTH, most=2)
    assert found == {"after": [], "brought": {}, "widths": {}}
    assert seen == []


def test_the_test_asked_for_is_judged_with_the_session_and_beside_a_random_one(case, session, ends):
    seen = ends(told(case, "named", 0.1), told(case, "nothing_detectable", 0.3))
    found = further(case, session, told(case, "nothing_detectable", 0.4), TRUTH, most=2)
    (row,) = found["after"]  # named: no second one
    assert (row["words"], row["expected"], row["verdict"]) == ("measure", 2.0, "named")
    assert (row["outcome"], row["named"]) == ("wrong name", ["payload"])
    assert len(seen) == 2
    assert all(len(more) == 1 for more in seen)
    assert found["widths"] == pytest.approx({"before": 0.4, "asked": 0.1, "random": 0.3})
    assert found["brought"] == {}  # it was asked for to narrow a range


def test_tests_follow_one_another_up_to_the_number_allowed(case, session, ends):
    nothing = told(case, "ambiguous", 0.2)
    seen = ends(nothing, nothing, nothing)
    found = further(case, session, nothing, TRUTH, most=2)
    assert len(found["after"]) == 2
    # The first, the random one in its place, then both asked for together.
    assert [len(more) for more in seen] == [1, 1, 2]
