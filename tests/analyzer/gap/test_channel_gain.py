"""Gains of several channels of one sensor at one point: one mounting, one finding."""

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import channel_gain, sensor_axes
from armodal.analyzer.gap.library import all_instances, together
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.hil_sim.study import study_arm


@pytest.fixture(scope="module")
def ordinary():
    return Ordinary(superset=Superset(study_arm("ur5").arm), postures=("p",))


def test_gains_at_one_point_are_one_finding(ordinary):
    z, x, y = (channel_gain.at_point(ordinary, axis, "14") for axis in "zxy")
    two = together(ordinary, z, x)
    assert two.place == "axes x+z at point 14"
    every = together(ordinary, two, y)
    assert every.place == "axes x+y+z at point 14"
    assert every.owned == tuple(f"ln gain {axis} at 14" for axis in "xyz")


def test_each_channel_has_its_own_gain(ordinary):
    class Made:
        mix = np.stack([np.eye(3)] * 2)
        lines = type("", (), {"sensor_point": np.array([0, 3])})

    made = Made()
    point = ordinary.arm.points[3].id
    both = channel_gain.at_point(ordinary, "x+z", point)
    both.builder(made, dict(zip(both.owned, np.log([0.5, 2.0]), strict=True)))
    np.testing.assert_array_equal(made.mix[0], np.eye(3))
    np.testing.assert_allclose(made.mix[1], np.diag([0.5, 1.0, 2.0]), rtol=1e-15)


def test_a_whole_sensor_may_have_one_gain(ordinary):
    whole = channel_gain.at_point(ordinary, "xyz", "14")
    assert whole.place == "axes xyz at point 14"
    assert len(whole.owned) == 1
    one_more = together(ordinary, channel_gain.at_point(ordinary, "y", "14"), whole)
    assert one_more.owned == ("ln gain xyz at 14", "ln gain y at 14")


def test_it_is_as_large_as_the_largest_of_them(ordinary):
    both = channel_gain.at_point(ordinary, "x+y", "14")
    x, y = both.owned
    assert both.is_material({x: 0.0, y: -0.3})
    assert not both.is_material({x: 0.01, y: 0.01})


def test_gains_elsewhere_and_other_effects_stay_apart(ordinary):
    here = channel_gain.at_point(ordinary, "x", "14")
    assert together(ordinary, here, channel_gain.at_point(ordinary, "y", "15")) is None
    (everywhere,) = (i for i in all_instances(ordinary) if i.place == "axis y")
    assert together(ordinary, here, everywhere) is None
    turn = sensor_axes.turned_sensor(ordinary, np.diag([1.0, -1.0, 1.0]), "14")
    assert together(ordinary, here, turn) is None


def test_a_gain_that_is_there_is_not_sought_again(ordinary):
    both = channel_gain.at_point(ordinary, "x+y", "14")
    assert not channel_gain.at_point(ordinary, "y", "14").goes_with((both,))
    assert channel_gain.at_point(ordinary, "z", "14").goes_with((both,))
    assert channel_gain.at_point(ordinary, "y", "15").goes_with((both,))
