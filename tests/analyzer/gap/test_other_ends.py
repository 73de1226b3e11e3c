"""A damper that was fitted between the wrong links leads to the one between the right ones."""

import json
from dataclasses import replace

import pytest
from support.small_case import small_case

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import coupling, nonproportional
from armodal.analyzer.gap.fit import fit_hypothesis
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.other_ends import other_ends
from armodal.analyzer.gap.stages import stages_of
from armodal.analyzer.identification.identify import estimate_frfs

STEPS = 9


@pytest.fixture(scope="module")
def damped():
    """Broad lines of an arm with a damper, the plain arm fitted to them, the damper's links."""
    case = small_case(3103, "rv4frl", "nonproportional")
    session = case.session()
    superset = Superset(session.header.arm)
    _, broad, *_ = stages_of(superset, session, estimate_frfs(session, superset))
    ordinary = Ordinary(superset=superset, postures=tuple(own.name for own in broad.lines))
    plain = fit_hypothesis(broad, Hypothesis(ordinary=ordinary), max_iterations=12)
    (hidden,) = json.loads(case.open_truth())["effects"]
    return broad, plain, " and ".join(hidden["place"])


def with_effect(broad, plain, instance):
    richer = replace(plain.hypothesis, instances=(instance,))
    start = {**plain.values, instance.size: 0.3 * instance.parameters[0].std}
    return fit_hypothesis(broad, richer, start=start, max_iterations=STEPS)


def test_from_between_any_links_the_right_ones_are_found(damped):
    broad, plain, place = damped
    fits = {
        instance.place: with_effect(broad, plain, instance)
        for instance in nonproportional.instances(plain.hypothesis.ordinary)
    }
    right = fits.pop(place)
    assert fits
    for wrong in fits.values():
        others = other_ends(broad, [wrong], STEPS)
        found = {other.hypothesis.instances[-1].place: other for other in others}
        assert set(found) == {place, *fits} - {wrong.hypothesis.instances[-1].place}
        # As far down as the one that began there: 3 nats are what a few steps more would bring.
        assert found[place].cost < min(wrong.cost, right.cost + 3.0)


def test_what_is_no_damper_starts_none(damped):
    broad, plain, _ = damped
    coupled = with_effect(broad, plain, coupling.instances(plain.hypothesis.ordinary)[0])
    assert other_ends(broad, [coupled], STEPS) == []
