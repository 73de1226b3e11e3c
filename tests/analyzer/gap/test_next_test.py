"""Expected evidence of a further test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.annealing import annealing_stages
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model import weigh
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.next_test.advice import advise, plan_text
from armodal.analyzer.gap.next_test.possible_tests import Doable, Test, possible_tests
from armodal.analyzer.gap.next_test.proposal import expected_evidence, hidden_rival, proposed
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.search.scan import scan_instances
from armodal.analyzer.gap.workflow import find_gap
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.hil_sim.study import make_case
from armodal.protocols.plan import load_plan, plan_from_text
from armodal.study.laboratory import SimulatedLaboratory


@pytest.fixture(scope="module")
def known():
    session = make_case(seed=9, arm="ur5").session()
    superset = Superset(session.header.arm)
    stage = annealing_stages(superset, session, estimate_frfs(session, superset))[0]
    ordinary = Ordinary(superset=superset, postures=tuple(p.name for p in stage.lines))
    return stage, fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=6)


@pytest.fixture(scope="module")
def servo(known):
    """The model with a servo that the session does not tell from none."""
    stage, null = known
    instances = all_instances(null.hypothesis.ordinary)
    found = scan_instances(stage, null, [i for i in instances if i.effect.name == "servo"])
    candidate = max(found, key=lambda c: c.size_std)
    return hidden_rival(stage, null, candidate, candidate.size_std)


# Derivatives are in single precision, their sums in another order.
ROUNDED = 1e-4


def test_a_model_is_not_told_from_itself(known):
    stage, null = known
    test = Test(joints_rad=stage.lines[0].joints_rad, hit_direction=np.eye(3)[2])
    # The same number on both sides; only rounding is left.
    assert expected_evidence(stage, [null, null], [test]) == pytest.approx([0.0], abs=1e-9)


def test_brakes_tell_a_servo_from_none_better_than_the_same_posture_without(known, servo):
    stage, null = known
    free = Test(joints_rad=stage.lines[0].joints_rad, hit_direction=stage.lines[0].hit_direction[0])
    braked = replace(free, brakes=True)
    without, with_brakes = expected_evidence(stage, [null, servo], [free, braked])
    assert with_brakes > without


def test_the_proposed_one_is_as_good_as_any_of_its_kind_and_the_same_each_time(known, servo):
    stage, null = known
    rivals = [null, servo]
    test, gain = proposed(stage, rivals, rng=np.random.default_rng(1))
    assert expected_evidence(stage, rivals, [test]) == pytest.approx([gain], rel=ROUNDED)
    tests = possible_tests(stage, null, rng=np.random.default_rng(1))
    assert gain >= expected_evidence(stage, rivals, tests).max()
    again, _ = proposed(stage, rivals, rng=np.random.default_rng(1))
    assert again.words == test.words
    assert proposed(stage, [null], rng=np.random.default_rng(1)) is None


def test_a_test_is_bettered_in_one_choice_at_a_time_within_what_can_be_done(known):
    stage, null = known
    arm = null.hypothesis.ordinary.arm
    can = Doable.of(stage, null)
    point = null.hypothesis.ordinary.superset.point_index
    own = Test(joints_rad=stage.lines[0].joints_rad, hit_direction=stage.lines[0].hit_direction[0])
    elsewhere = can.hit_on(own, can.hit_points[0])
    for test in (own, elsewhere):
        beside = list(can.beside(test, np.random.default_rng(3)))
        assert len({other.words for other in beside} - {test.words}) == len(beside)
        for other in beside:
            moved = np.any(other.joints_rad != test.joints_rad)
            hit = other.hit_point != test.hit_point or (
                # The same point's surface turns with the arm.
                not moved and np.any(other.hit_direction != test.hit_direction)
            )
            changed = [moved, hit, other.brakes, other.known_mass is not None]
            assert sum(map(bool, changed)) == 1
            if other.hit_point is not None:
                turn = null.hypothesis.ordinary.superset.posture(other.joints_rad).point_rotation
                inward = -turn[point[other.hit_point]][:, 2]
                np.testing.assert_allclose(other.hit_direction, inward, atol=1e-12)
            for angle, joint in zip(other.joints_rad, arm.joints, strict=True):
                assert joint.range_rad[0] <= angle <= joint.range_rad[1]


def test_other_points_are_hit_square_to_the_surface_their_sensors_stand_on(known):
    stage, null = known
    tests = possible_tests(stage, null, rng=np.random.default_rng(2))
    elsewhere = [test for test in tests if test.hit_point is not None]
    superset = null.hypothesis.ordinary.superset
    links = {superset.point_link[superset.point_index[test.hit_point]] for test in elsewhere}
    assert len(links) == len(elsewhere) > 1
    assert superset.point_link[stage.lines[0].hit_point[0]] not in links
    for test in elsewhere:
        point = superset.point_index[test.hit_point]
        outward = superset.posture(test.joints_rad).point_rotation[point][:, 2]
        np.testing.assert_allclose(test.hit_direction, -outward, atol=1e-12)
        assert f"hits on point {test.hit_point}" in test.words


def test_hits_elsewhere_foretell_what_the_session_s_own_point_would_not(known, servo):
    stage, null = known
    own = Test(joints_rad=stage.lines[0].joints_rad, hit_direction=stage.lines[0].hit_direction[0])
    where = null.hypothesis.ordinary.arm.points[stage.lines[0].hit_point[0]].id
    again = replace(own, hit_point=where)
    by_own, by_again = expected_evidence(stage, [null, servo], [own, again])
    assert by_again == pytest.approx(by_own, rel=ROUNDED)
    tests = possible_tests(stage, null, rng=np.random.default_rng(2))
    elsewhere = replace(own, hit_point=next(t.hit_point for t in tests if t.hit_point is not None))
    (by_other,) = expected_evidence(stage, [null, servo], [elsewhere])
    assert by_other != pytest.approx(by_own, rel=1e-3)


@pytest.mark.long
def test_tests_weighed_at_once_are_as_good_as_each_alone(known, servo):
    """All kinds there are; with brakes or not, with a point more or not, many of a kind."""
    stage, null = known
    tests = possible_tests(stage, null, rng=np.random.default_rng(3))
    point = null.hypothesis.ordinary.arm.points[-1].id
    own = replace(tests[0], more_points=(point,))
    kinds = {
        (t.hit_point is None, t.brakes, len(t.peaks_n), t.known_mass is None): t for t in tests
    }
    assert len(kinds) >= 4
    mixed = [own, *tests[:5], replace(tests[1], brakes=True), *kinds.values()]
    alone = [expected_evidence(stage, [null, servo], [test])[0] for test in mixed]
    assert len(set(np.round(alone, 6))) > len(mixed) // 2
    at_once = expected_evidence(stage, [null, servo], mixed)
    np.testing.assert_allclose(at_once, alone, rtol=ROUNDED, atol=ROUNDED)


def test_base_points_that_were_left_out_are_asked_for_once_and_where_the_sensor_moves(known):
    stage, null = known
    arm = null.hypothesis.ordinary.arm
    lines = stage.lines[0]
    at_base = [i for i, link in enumerate(null.hypothesis.ordinary.superset.point_link) if link < 0]
    ids = {arm.points[i].id for i in at_base}
    kept = np.flatnonzero(~np.isin(lines.sensor_point, at_base))
    parts = ("sensor_point", "hit", "values", "variance")
    without = [replace(own, **{n: getattr(own, n)[kept] for n in parts}) for own in stage.lines]

    def asked(lines):
        shown = Stage(null.hypothesis.ordinary.superset, lines, Discrepancy(), models=stage.models)
        tests = possible_tests(shown, null, rng=np.random.default_rng(1))
        return [test for test in tests if test.more_points]

    assert ids
    assert asked(stage.lines) == []
    found = asked(without)
    assert all(set(test.more_points) == ids for test in found)
    plan = load_plan("ur5-five-postures", arm)  # it has them: they were skipped
    text = plan_text(found[0], plan, arm, comment="why")
    (posture,) = plan_from_text(text, arm).postures
    assert posture.points == plan.postures[0].points
    two_hits = [replace(own, hit_point=np.array([0, 1])) for own in without]
    assert asked(two_hits) == []


def test_what_a_casting_may_do_weighs_down_points_of_the_base_alone(known, monkeypatch):
    stage, null = known
    bases = [i for i in all_instances(null.hypothesis.ordinary) if i.effect.name == "base"]
    (rocking,) = scan_instances(stage, null, bases)
    rival = hidden_rival(stage, null, rocking, 30.0 * rocking.size_std)
    superset = null.hypothesis.ordinary.superset
    ids = [p.id for p in null.hypothesis.ordinary.arm.points]
    lines = stage.lines[0]
    free = Test(joints_rad=lines.joints_rad, hit_direction=lines.hit_direction[0])
    at_base = [i for i, link in enumerate(superset.point_link) if link < 0]
    kept = np.flatnonzero(~np.isin(lines.sensor_point, at_base))
    parts = ("sensor_point", "hit", "values", "variance")
    without = [replace(own, **{n: getattr(own, n)[kept] for n in parts}) for own in stage.lines]
    shown = Stage(superset, without, Discrepancy(), models=stage.models)
    tests = [free, replace(free, more_points=tuple(ids[i] for i in at_base))]
    doubted = expected_evidence(shown, [null, rival], tests)
    monkeypatch.setattr(weigh, "BASE_GAIN_STD", 0.0)
    sure = expected_evidence(shown, [null, rival], tests)
    assert sure[0] == doubted[0]
    assert sure[1] > doubted[1] > doubted[0]


def test_hits_that_the_arm_hardly_answers_tell_nothing_for_noise_stays(known, servo):
    stage, null = known
    superset = null.hypothesis.ordinary.superset
    on_base = next(i for i, link in enumerate(superset.point_link) if link < 0)
    test = Test(
        joints_rad=stage.lines[0].joints_rad,
        hit_direction=np.eye(3)[2],
        hit_point=superset.arm.points[on_base].id,
    )
    # The floor gives way by a thousandth of the arm's compliance: what answers drowns in the noise.
    # A test is worth its hour from 3 nats on; a tenth of that is nothing.
    assert expected_evidence(stage, [null, servo], [test]) == pytest.approx([0.0], abs=0.3)


@pytest.mark.long
def test_hits_that_hardly_move_a_mode_are_not_asked_for():
    """They were to tell an axis from none, and what their aim made of a mode was unknown."""
    case = make_case(1, "ur5", ladder=True)
    session = case.session()
    asked = find_gap(session, gates=False, modes=False).result.next_test
    plan = plan_from_text(asked.plan_toml, case.arm, origin="next test")
    test = SimulatedLaboratory(case=case).measure(plan, 2)
    found = find_gap(session, more=[test], gates=False, modes=False, advice=False).result
    assert found.verdict is Verdict.NOTHING_DETECTABLE
    assert not any("hits hardly move" in note for note in found.notes)


def test_rivals_that_no_test_tells_apart_are_said_to_be_so(known):
    stage, null = known
    plan = load_plan("ur5-five-postures", null.hypothesis.ordinary.arm)
    found = advise(stage, null, (null, null), [], [], lambda _: (), plan, lambda _: None)
    assert found.test is None
    assert found.why_none.endswith("to tell apart: nothing missing or nothing missing")


def test_a_rival_with_little_evidence_is_worth_a_test_before_what_only_hides(known, servo):
    stage, null = known
    plan = load_plan("ur5-five-postures", null.hypothesis.ordinary.arm)

    def advised(evidence):
        weak = replace(servo, cost=servo.cost + null.evidence - evidence - servo.evidence)
        return advise(stage, null, (), [weak], [], lambda _: (), plan, lambda _: None).test

    assert advised(5.0) is None  # nothing hides either
    found = advised(30.0)
    assert found is not None
    assert "Servo and rotor behind the transmission" in found.why
    (posture,) = plan_from_text(found.plan_toml, null.hypothesis.ordinary.arm).postures
    assert posture.name == "next test"


def test_every_possible_test_is_within_the_joints_ranges(known):
    stage, null = known
    for test in possible_tests(stage, null, rng=np.random.default_rng(2)):
        for angle, joint in zip(test.joints_rad, null.hypothesis.ordinary.arm.joints, strict=True):
            assert joint.range_rad[0] <= angle <= joint.range_rad[1]
