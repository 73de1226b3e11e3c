"""Turns of a sensor, one after the other."""

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects.sensor_axes import FLIPPED, SWAPPED, together, turned_sensor
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.hil_sim.study import study_arm

ROUND = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # x is y, y is z, z is x
Y_AND_Z = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def ordinary():
    return Ordinary(superset=Superset(study_arm("ur5").arm), postures=("p",))


def test_two_turns_at_one_point_are_one(ordinary):
    both = together(
        ordinary, turned_sensor(ordinary, ROUND, "14"), turned_sensor(ordinary, Y_AND_Z, "14")
    )
    assert both is not None
    assert both.effect is SWAPPED
    # What was recorded first as y, z, x has its last two exchanged: y, x, z.
    assert both.place == "point 14: x is y, y is x"


def test_two_exchanges_may_leave_a_flip(ordinary):
    y_and_minus_z = Y_AND_Z @ np.diag([1.0, -1.0, 1.0])
    both = together(
        ordinary,
        turned_sensor(ordinary, Y_AND_Z, None),
        turned_sensor(ordinary, y_and_minus_z, None),
    )
    assert both is not None
    assert both.effect is FLIPPED
    assert both.place == "the roving sensor: z is -z"


def test_turns_elsewhere_of_nothing_and_other_effects_stay_apart(ordinary):
    here, there = (turned_sensor(ordinary, ROUND, point) for point in ("14", "15"))
    assert together(ordinary, here, there) is None
    assert together(ordinary, here, turned_sensor(ordinary, ROUND, None)) is None
    assert together(ordinary, here, turned_sensor(ordinary, ROUND.T, "14")) is None
    assert together(ordinary, here, all_instances(ordinary)[0]) is None
