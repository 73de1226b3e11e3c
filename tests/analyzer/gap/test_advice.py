"""A next test that cannot be written as a plan: the advice says why, and nothing is raised."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import gravity_compensator, microslip, softening
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.next_test import advice
from armodal.analyzer.gap.next_test.advice import advise, plan_text
from armodal.analyzer.gap.next_test.possible_tests import Test
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import load_plan, plan_from_text

UNWRITTEN = "the next test cannot be written as a plan: proposed plan: "


@pytest.fixture(scope="module")
def arm():
    return load_arm("ur5")


@pytest.fixture(scope="module")
def plan(arm):
    return load_plan("ur5-five-postures", arm)


@pytest.fixture(scope="module")
def ordinary(arm):
    return Ordinary(superset=Superset(arm), postures=("one", "other"))


def advised(plan, standing, *, peak_n=30.0):
    stage = SimpleNamespace(lines=[SimpleNamespace(peak_n=peak_n)])
    return advise(stage, standing[0], standing, [], [], lambda _: (), plan, lambda _: None)


def fit_of(ordinary, *instances):
    """What advice reads of a fit."""
    title = instances[-1].title if instances else "nothing missing"
    return SimpleNamespace(
        hypothesis=Hypothesis(ordinary=ordinary, instances=instances),
        title=title,
        evidence=0.0,
        last=instances[-1] if instances else None,
    )


def proposing(monkeypatch, test):
    """Let the search for a test end with this one."""
    monkeypatch.setattr(advice, "proposed", lambda *_, **__: (test, 50.0))


def test_hits_at_levels_that_no_plan_can_ask_for_are_told_and_not_raised(plan, ordinary):
    standing = [fit_of(ordinary, gravity_compensator.instances(ordinary)[0]), fit_of(ordinary)]
    assert advised(plan, standing).test is not None
    # A third of a tenth of a newton is no peak: the file keeps tenths.
    found = advised(plan, standing, peak_n=0.1)
    assert found.test is None
    assert found.why_none.startswith(UNWRITTEN)
    assert "peaks_n" in found.why_none


def test_a_posture_that_no_plan_can_ask_for_is_told_and_not_raised(
    arm, plan, ordinary, monkeypatch
):
    standing = [fit_of(ordinary), fit_of(ordinary)]
    own = Test(joints_rad=plan.postures[0].joints_rad, hit_direction=np.eye(3)[2])
    proposing(monkeypatch, own)
    assert advised(plan, standing).test is not None
    proposing(monkeypatch, replace(own, joints_rad=np.full(len(arm.joints), 9.0)))
    found = advised(plan, standing)
    assert (found.test, found.compared) == (None, ())
    assert found.why_none.startswith(UNWRITTEN)
    assert "joints_deg" in found.why_none


def test_an_arm_by_another_name_has_its_next_test(arm, plan, monkeypatch):
    other = replace(arm, name="as believed")
    ordinary = Ordinary(superset=Superset(other), postures=("one", "other"))
    alike = [fit_of(ordinary, gravity_compensator.instances(ordinary)[0]), fit_of(ordinary)]
    proposing(monkeypatch, Test(joints_rad=plan.postures[0].joints_rad, hit_direction=np.eye(3)[2]))
    for standing in (alike, [fit_of(ordinary), fit_of(ordinary)]):
        found = advised(plan, standing)
        assert plan_from_text(found.test.plan_toml, other).arm == "as believed"


def test_two_laws_of_one_joint_ask_for_hits_between_soft_and_hard(plan, ordinary, monkeypatch):
    """By two levels a seat that slips may lose as little as a spring that softens."""
    own = Test(joints_rad=plan.postures[0].joints_rad, hit_direction=np.eye(3)[2])
    proposing(monkeypatch, own)
    two, three = (replace(ordinary, level_span=1.0, hits_between=b) for b in (False, True))

    def test_for(of, *places):
        joints = [of.arm.joints[of.elastic[place]].name for place in places]
        kinds = zip((softening, microslip), joints, strict=True)
        laws = [kind.laws(of, joint, 3e-5, 100.0)[0] for kind, joint in kinds]
        return advised(plan, [fit_of(of, law) for law in laws]).test

    assert "hits of about 10, 30, 75 N" in test_for(two, 0, 0).words
    for other in (test_for(three, 0, 0), test_for(two, 0, 1)):
        assert other.words.startswith(own.words)


def test_a_test_alone_as_a_plan_is_refused_where_the_arm_cannot_do_it(arm, plan):
    beyond = Test(joints_rad=np.full(len(arm.joints), 9.0), hit_direction=np.eye(3)[2])
    with pytest.raises(PlanError, match="joints_deg"):
        plan_text(beyond, plan, arm, comment="why")
