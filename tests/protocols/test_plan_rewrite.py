"""A proposed posture as a plan file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.daq.judge import JudgeLimits
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import load_plan, plan_from_text
from armodal.protocols.plan_records import KnownMass
from armodal.protocols.plan_rewrite import text_with_peaks, text_with_posture


@pytest.fixture(scope="module")
def arm():
    return load_arm("rv4frl")


@pytest.fixture(scope="module")
def plan(arm):
    return load_plan("rv4frl-three-postures", arm)


def test_one_posture_stands_in_the_place_of_all_and_the_rest_is_as_it_was(arm, plan):
    body = KnownMass(link="hand_flange", mass_kg=1.5, center_m=np.array([0.0, 0.01, 0.02]))
    wanted = replace(
        plan.postures[1], name="next test", validation=False, brakes=True, known_mass=body
    )
    made = plan_from_text(text_with_posture(plan, arm, wanted, comment="why"), arm)
    (posture,) = made.postures
    assert posture.brakes
    assert posture.known_mass is not None
    assert posture.known_mass.link == "hand_flange"
    assert posture.known_mass.mass_kg == 1.5
    np.testing.assert_array_equal(posture.known_mass.center_m, body.center_m)
    assert posture.points == wanted.points
    # The file keeps hundredths of a degree.
    np.testing.assert_allclose(posture.joints_rad, wanted.joints_rad, atol=np.deg2rad(0.006))
    assert (made.sampling, made.trigger, made.windows) == (
        plan.sampling,
        plan.trigger,
        plan.windows,
    )
    assert made.postures[0].tolerance_rad == pytest.approx(wanted.tolerance_rad, rel=1e-6)
    assert (made.hits_per_point, made.max_attempts) == (plan.hits_per_point, plan.max_attempts)
    assert made.name != plan.name


def test_a_posture_the_arm_cannot_reach_is_refused(arm, plan):
    beyond = replace(plan.postures[0], joints_rad=np.full(len(arm.joints), 9.0))
    with pytest.raises(PlanError, match="joints_deg"):
        text_with_posture(plan, arm, beyond, comment="why")


def test_a_joint_measured_a_little_beyond_its_range_is_put_at_the_end(arm, plan):
    high_rad = np.array([joint.range_rad[1] for joint in arm.joints])
    low_rad = np.array([joint.range_rad[0] for joint in arm.joints])
    for end_rad, outwards in ((high_rad, 1.0), (low_rad, -1.0)):

        def made(over_deg, end_rad=end_rad, outwards=outwards):
            beyond = end_rad + outwards * np.deg2rad(over_deg)
            wanted = replace(plan.postures[0], joints_rad=beyond)
            return plan_from_text(text_with_posture(plan, arm, wanted, comment="why"), arm)

        # The file keeps hundredths of a degree.
        np.testing.assert_allclose(made(0.1).postures[0].joints_rad, end_rad, atol=np.deg2rad(6e-3))
        # Further than the tolerance it would be another posture.
        with pytest.raises(PlanError, match="joints_deg"):
            made(np.rad2deg(plan.postures[0].tolerance_rad) + 0.1)


def test_a_posture_keeps_its_tolerance_and_is_never_for_validation(arm, plan):
    wanted = replace(plan.postures[0], tolerance_rad=np.deg2rad(0.8), validation=True)
    made = plan_from_text(text_with_posture(plan, arm, wanted, comment="why"), arm)
    assert made.postures[0].tolerance_rad == pytest.approx(wanted.tolerance_rad, rel=1e-6)
    assert not made.postures[0].validation


def test_the_plan_is_for_the_arm_at_hand_whatever_its_name(arm, plan):
    other = replace(arm, name="as believed")
    posed = text_with_posture(plan, other, plan.postures[0], comment="why")
    levelled = text_with_peaks(plan, other, (6.0, 30.0, 150.0), comment="why")
    for text in (posed, levelled):
        assert plan_from_text(text, other).arm == "as believed"


def test_attempts_are_enough_for_one_hit_a_peak(arm, plan):
    once = plan.text.replace("hits_per_point = 3", "hits_per_point = 1")
    own = plan_from_text(once.replace("max_attempts = 12", "max_attempts = 2"), arm)
    assert (own.hits_per_point, own.max_attempts) == (1, 2)
    peaks_n = (6.0, 30.0, 150.0)
    wanted = replace(own.postures[0], peaks_n=peaks_n)
    posed = text_with_posture(own, arm, wanted, comment="why")
    for text in (posed, text_with_peaks(own, arm, peaks_n, comment="why")):
        made = plan_from_text(text, arm)
        assert (made.hits_per_point, made.max_attempts) == (3, 3)
    # More than enough stays as it was.
    many = plan_from_text(text_with_peaks(plan, arm, peaks_n, comment="why"), arm)
    assert many.max_attempts == plan.max_attempts


def test_a_known_mass_on_a_link_that_is_not_there_is_refused(arm, plan):
    body = KnownMass(link="tail", mass_kg=1.0, center_m=np.zeros(3))
    with pytest.raises(PlanError, match=r"known_mass\.link: wanted a link of the arm"):
        text_with_posture(plan, arm, replace(plan.postures[0], known_mass=body), comment="why")


def test_the_trigger_sees_the_softest_hits_that_are_wanted(arm, plan):
    def made(*peaks_n):
        wanted = replace(plan.postures[0], peaks_n=peaks_n)
        return plan_from_text(text_with_posture(plan, arm, wanted, comment="why"), arm)

    soft = made(6.0, 30.0, 150.0)
    assert soft.trigger.level_n * JudgeLimits().soft < 6.0
    assert soft.trigger.rising == plan.trigger.rising
    assert soft.postures[0].peaks_n == (6.0, 30.0, 150.0)
    # Where the plan's own trigger sees them it stays.
    assert made(30.0, 70.0, 150.0).trigger == plan.trigger


def test_hits_at_levels_are_asked_for_in_every_posture_and_little_else_changes(arm, plan):
    peaks_n = (6.04, 30.0, 150.0)
    made = plan_from_text(text_with_peaks(plan, arm, peaks_n, comment="why"), arm)
    assert {posture.peaks_n for posture in made.postures} == {(6.0, 30.0, 150.0)}
    for posture, was in zip(made.postures, plan.postures, strict=True):
        assert (posture.name, posture.points, posture.validation) == (
            was.name,
            was.points,
            was.validation,
        )
        np.testing.assert_array_equal(posture.joints_rad, was.joints_rad)
    assert made.hits_per_point == max(plan.hits_per_point, 3)
    assert made.trigger.level_n * JudgeLimits().soft < 6.0
    assert made.fixed_point == plan.fixed_point
