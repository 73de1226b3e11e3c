"""Steps of the fit's parameters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from support.small_fit import state_of, true_axis, true_structure

from armodal.analyzer.identification.parameters import (
    ParameterNames,
    parameter_vector,
    step_state,
)
from armodal.analyzer.screws import line_angle_rad, line_distance_m

STATE = state_of(true_structure([true_axis()]), 2)
N = 6 + 6 + 3 + 4


@given(arrays(np.float64, N, elements=st.floats(-0.5, 0.5)))
def test_a_step_keeps_springs_positive_and_axes_a_unit_line_from_its_nearest_point(step):
    moved = step_state(STATE, step)
    (axis,) = moved.structure.axes
    assert (moved.structure.all_stiffness() > 0).all()
    assert (moved.structure.all_damping() > 0).all()
    assert np.linalg.norm(axis.direction) == pytest.approx(1.0, abs=1e-14)
    assert axis.direction @ axis.point_m == pytest.approx(0.0, abs=1e-14)


def test_logarithms_step_by_factors(arm):
    names = ParameterNames.of(arm, STATE.structure, ("a", "b")).names
    step = np.zeros(N)
    step[names.index("ln k joint_2")] = np.log(2.0)
    step[names.index("ln c axis 1")] = np.log(0.5)
    moved = step_state(STATE, step).structure
    assert moved.all_stiffness() / STATE.structure.all_stiffness() == pytest.approx([1, 2, 1, 1])
    assert moved.all_damping() / STATE.structure.all_damping() == pytest.approx([1, 1, 1, 0.5])


def test_tilts_turn_the_axis_by_their_angle_and_shifts_move_it_by_their_length(arm):
    names = ParameterNames.of(arm, STATE.structure, ("a", "b")).names
    before = STATE.structure.axes[0]
    for side in "ab":
        step = np.zeros(N)
        step[names.index(f"tilt {side} axis 1")] = 0.01
        (tilted,) = step_state(STATE, step).structure.axes
        # The step is the tangent of the angle.
        assert np.tan(line_angle_rad(tilted.direction, before.direction)) == pytest.approx(0.01)
        step = np.zeros(N)
        step[names.index(f"shift {side} axis 1")] = 0.01
        (shifted,) = step_state(STATE, step).structure.axes
        np.testing.assert_allclose(shifted.direction, before.direction, atol=1e-15)
        distance = line_distance_m(before.point_m, shifted.point_m, shifted.direction)
        assert distance == pytest.approx(0.01)


def test_only_nuisances_have_priors_and_offsets_from_them(arm):
    names = ParameterNames.of(arm, STATE.structure, ("a", "b"))
    free = np.isinf(names.prior_std)
    assert free.sum() == 12
    t = arm.tolerances
    assert names.prior_std[12] == pytest.approx(np.hypot(t.sensor_gain, t.hammer_gain))
    assert names.prior_std[-1] == t.hit_direction_rad
    step = np.arange(1.0, N + 1) / 100
    offsets = parameter_vector(step_state(STATE, step))
    np.testing.assert_allclose(offsets, np.where(free, 0.0, step))
