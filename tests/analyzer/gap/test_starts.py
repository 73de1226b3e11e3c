"""Where fits begin when an effect is taken out."""

from types import SimpleNamespace

import numpy as np
import pytest

from analyzer.arm.superset import Superset
from analyzer.gap.effects import link_axis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.library import all_instances
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.starts import taken_out
from hil_sim.study import study_arm


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
