"""Where fits begin when an effect is taken out, or another put in its place."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.long_link import long_links
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.starts import axes_of_bearings, spread_of, taken_out
from armodal.hil_sim.study import study_arm


@pytest.fixture(scope="module")
def ordinary():
    return Ordinary(superset=Superset(study_arm("bench57").arm), postures=("p",))


def fit_with(ordinary, link, direction):
    """An axis in a link beside the bearings of all joints, values only."""
    axis = link_axis.at_axis(ordinary, link, direction, np.zeros(3))
    bearings = [i for i in all_instances(ordinary) if i.effect.name == "bearing"]
    hypothesis = Hypothesis(ordinary=ordinary, instances=(*bearings, axis))
    space = hypothesis.space()
    values = space.values(space.start({axis.size: 4e-6}))
    return SimpleNamespace(hypothesis=hypothesis, values=values), axis, bearings


def test_the_bearing_of_its_joint_takes_what_an_axis_across_it_was(ordinary):
    link = 2
    joint = ordinary.arm.joints[link]
    across = np.cross(joint.axis, [0.3, 0.5, 0.7])
    fit, axis, bearings = fit_with(ordinary, link, across / np.linalg.norm(across))
    start, rest = taken_out(fit, axis)
    assert axis not in rest.instances
    assert set(start) == set(fit.values) - {p.name for p in axis.parameters}
    (own,) = (b for b in bearings if b.place == joint.name)
    more = [start[name] - fit.values[name] for name in own.sizes]
    # Across the joint's axis nothing of it is lost: sin^2 + cos^2 = 1.
    assert sum(more) == pytest.approx(4e-6)
    assert min(more) >= 0.0


def test_bearings_elsewhere_and_other_effects_keep_their_values(ordinary):
    fit, axis, bearings = fit_with(ordinary, 2, np.array([1.0, 0.0, 0.0]))
    start, _ = taken_out(fit, axis)
    ends = {ordinary.arm.joints[2].name, ordinary.arm.joints[3].name}
    far = [name for b in bearings if b.place not in ends for name in b.sizes]
    assert all(start[name] == fit.values[name] for name in far)
    gone = bearings[0]
    start, rest = taken_out(fit, gone)
    assert gone not in rest.instances
    kept = {name: v for name, v in fit.values.items() if name in start}
    assert kept == start


def alone(ordinary, link, direction):
    fit, axis, _ = fit_with(ordinary, link, direction / np.linalg.norm(direction))
    return SimpleNamespace(
        hypothesis=Hypothesis(ordinary=ordinary, instances=(axis,)), values=fit.values
    ), axis


def test_an_axis_along_a_long_link_starts_its_twist_and_one_across_its_bending(ordinary):
    for line in long_links(ordinary):
        across = np.cross(line.along, [0.3, 0.5, 0.7])
        for direction, kind in ((line.along, "link_torsion"), (across, "link_bending")):
            fit, axis = alone(ordinary, line.link, direction)
            spread, start = spread_of(axis, fit)
            assert (spread.effect.name, spread.place) == (kind, line.name)
            # As soft from root to tip: per length times the length.
            assert start[spread.size] * line.length_m == pytest.approx(fit.values[axis.size])
            assert not set(start) & {p.name for p in axis.parameters}


def test_a_short_link_and_one_that_gives_way_already_start_nothing(ordinary):
    lines = {line.link: line for line in long_links(ordinary)}
    short = next(i for i in range(len(ordinary.arm.joints)) if i not in lines)
    fit, axis = alone(ordinary, short, np.array([0.0, 0.0, 1.0]))
    assert spread_of(axis, fit) is None
    line = next(iter(lines.values()))
    fit, axis = alone(ordinary, line.link, line.along)
    spread, _ = spread_of(axis, fit)
    both = Hypothesis(ordinary=ordinary, instances=(spread, axis))
    assert spread_of(axis, SimpleNamespace(hypothesis=both, values=fit.values)) is None


def test_a_bearing_that_ended_rigid_both_ways_starts_no_axis(ordinary):
    plain = Hypothesis(ordinary=ordinary)
    bearing = next(i for i in all_instances(ordinary) if i.effect.name == "bearing")
    values = dict.fromkeys(bearing.sizes, 0.0)
    hypothesis = replace(plain, instances=(bearing,))
    rigid = SimpleNamespace(hypothesis=hypothesis, last=bearing, values=values)
    assert axes_of_bearings(None, plain, [rigid]) == []
