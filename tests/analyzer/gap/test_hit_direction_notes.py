"""Postures whose hits hardly move a mode."""

import numpy as np
import pytest
from support.bench_effects import instance_of
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.annealing import annealing_stages, with_test
from armodal.analyzer.gap.inference.fit import fit_hypothesis
from armodal.analyzer.gap.inference.hit_direction_notes import hit_direction_notes
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.next_test.advice import plan_text
from armodal.analyzer.gap.next_test.possible_tests import Test
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.protocols.plan import plan_from_text

# Hits on point 3 of the flange along this go nearly through the axis of joint 5.
POSTURE_DEG = [9.85, -25.06, 60.92, -63.09, -89.6, 7.84]
THROUGH_AXIS_5 = np.array([-0.259, 0.966, 0.0])


@pytest.fixture(scope="module")
def measured():
    """The case, its session, the arm's models and the stages of a search."""
    case = small_case(9, "ur5")
    session = case.session()
    superset = Superset(session.header.arm)
    return (
        case,
        session,
        superset,
        annealing_stages(superset, session, estimate_frfs(session, superset)),
    )


def notes(measured, direction):
    """Of the plan's postures, and the one above with hits along a direction."""
    case, session, superset, stages = measured
    test = Test(
        joints_rad=np.deg2rad(POSTURE_DEG),
        hit_direction=direction / np.linalg.norm(direction),
        hit_point="3",
    )
    text = plan_text(test, session.header.plan, case.arm, comment="test")
    more = case.session(plan_from_text(text, case.arm, origin="test"), run=1)
    stage = with_test(stages, superset, more, 2)[-1]
    ordinary = Ordinary(superset=superset, postures=tuple(p.name for p in stage.lines))
    fit = fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=6)
    named = instance_of(ordinary, "hit_direction", "posture next test")
    widened = Hypothesis(ordinary=ordinary, instances=(named,))
    found = hit_direction_notes(stage, fit)
    again = fit_hypothesis(stage, widened, start=fit.values, max_iterations=0)
    assert hit_direction_notes(stage, again) == found  # that aim's wider prior is no tolerance
    return found


def test_hits_through_an_axis_are_said_to_hardly_move_it_and_those_across_are_not(measured):
    through = notes(measured, THROUGH_AXIS_5)
    assert len(through) == 1
    assert "'next test (test 2)': hits hardly move what answers at" in through[0]
    assert notes(measured, np.array([0.966, 0.259, 0.0])) == []
