"""Where soft and hard hits are apart: which effect of the level goes on beside the others."""

import json
from dataclasses import replace

import pytest
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.by_level import promising_by_level
from armodal.analyzer.gap.fit import fit_hypothesis
from armodal.analyzer.gap.hit_levels import middle_level
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.levels import told_apart
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.stages import stages_of
from armodal.analyzer.gap.weigh import Discrepancy
from armodal.analyzer.identification.identify import estimate_frfs


@pytest.fixture(scope="module")
def slipping():
    """Broad lines of an arm with friction at a joint, the plain arm fitted to them, the joint."""
    case = small_case(3001, "rv4frl", "friction", ladder=True)
    session = case.session()
    superset = Superset(session.header.arm)
    about = middle_level(session)
    stages = stages_of(superset, session, estimate_frfs(session, superset), level_about=about)
    names = tuple(dict.fromkeys(own.name for own in stages[0].lines))
    span = max(own.level for own in stages[0].lines)
    ordinary = Ordinary(superset=superset, postures=names, level_span=span)
    stages, _ = told_apart(superset, stages, Hypothesis(ordinary=ordinary), {}, Discrepancy())
    plain = fit_hypothesis(stages[1], Hypothesis(ordinary=ordinary), max_iterations=12)
    (hidden,) = json.loads(case.open_truth())["effects"]
    return stages[1], plain, hidden


def test_the_one_that_is_hidden_goes_on(slipping):
    broad, plain, hidden = slipping
    (found,) = promising_by_level(broad, plain, {})
    (instance,) = found.hypothesis.instances
    assert instance.by_level
    assert instance.place == hidden["place"]
    assert found.cost < plain.cost


def test_no_second_one_goes_on_beside_it_and_none_where_hits_are_not_apart(slipping):
    broad, plain, _ = slipping
    (found,) = promising_by_level(broad, plain, {})
    assert promising_by_level(broad, found, {}) == []
    level = replace(plain.hypothesis.ordinary, level_span=0.0)
    averaged = replace(plain, hypothesis=replace(plain.hypothesis, ordinary=level))
    assert promising_by_level(broad, averaged, {}) == []
