"""Twist to Mozzi axis and back, and the published formulas beside it."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from armodal.analyzer.screws import (
    MozziAxis,
    Translation,
    line_angle_rad,
    line_distance_m,
    mozzi_axis,
)

# Metres and radians of a body of about a metre; nothing so small that its square underflows.
number = st.floats(-10, 10).map(lambda x: 0.0 if abs(x) < 1e-6 else x)
vectors = arrays(np.float64, 3, elements=number)


def twist_of(axis):
    """Velocity of the body point at the origin, and rotation, of a motion about an axis."""
    angular = axis.rotation * axis.direction
    return np.concatenate(
        [np.cross(axis.point_m, angular) + axis.pitch_m_per_rad * angular, angular]
    )


@given(vectors, vectors)
def test_twist_to_axis_and_back(linear, angular):
    assume(np.linalg.norm(angular) > 1e-3)
    axis = mozzi_axis(np.concatenate([linear, angular]))
    assert isinstance(axis, MozziAxis)
    # |v| / |w| up to 1e4 cancels in the cross products: 1e4 roundings of |v|.
    np.testing.assert_allclose(twist_of(axis), [*linear, *angular], atol=1e-11)


@given(vectors, vectors, st.floats(1e-3, 1e3))
def test_a_larger_motion_has_the_same_axis(linear, angular, factor):
    assume(np.linalg.norm(angular) > 1e-3)
    twist = np.concatenate([linear, angular])
    small, large = mozzi_axis(twist), mozzi_axis(factor * twist)
    np.testing.assert_allclose(large.direction, small.direction, atol=1e-12)
    # The point lies up to |v| / |w| = 1e4 m away.
    np.testing.assert_allclose(large.point_m, small.point_m, atol=1e-8)


def test_a_rotation_within_rounding_of_the_motion_is_none():
    assert isinstance(mozzi_axis([1.0, 0, 0, 0, 0, 1e-10]), Translation)
    assert isinstance(mozzi_axis([1.0, 0, 0, 0, 0, 1e-10], length_m=100.0), MozziAxis)


def test_no_motion_is_a_translation_by_nothing():
    motion = mozzi_axis(np.zeros(6))
    assert isinstance(motion, Translation)
    np.testing.assert_array_equal(motion.displacement, np.zeros(3))


@given(arrays(np.float64, 4, elements=st.floats(0.1, 3)))
def test_file_000_equations_eight_and_nine_are_the_case_without_w_x_and_v_y(values):
    v_x, v_z, w_y, w_z = values
    axis = mozzi_axis([v_x, 0.0, v_z, 0.0, w_y, w_z])
    # Eqs. (8) and (9); the pitch is w.v / |w|² and moves no point of the line.
    slope, intercept = w_z / w_y, -v_x / w_y
    x, y, z = axis.point_m
    assert x == pytest.approx(w_y * v_z / (w_y**2 + w_z**2), rel=1e-12)
    assert z == pytest.approx(slope * y + intercept, rel=1e-9, abs=1e-12)
    assert axis.direction[2] / axis.direction[1] == pytest.approx(slope, rel=1e-12)


@given(vectors, vectors, vectors)
def test_file_001_equation_fourteen_gives_points_of_the_axis(linear, angular, reference):
    assume(np.linalg.norm(angular) > 1e-2)
    axis = mozzi_axis(np.concatenate([linear, angular]))
    wx, wy, wz = angular
    # The velocity of a reference point Q; mu = 0.
    vx, vy, vz = linear + np.cross(angular, reference)
    w2 = angular @ angular
    point = reference + np.array(
        [-wz * vy / w2 + wy * vz / w2, wz * vx / w2 - wx * vz / w2, -wy * vx / w2 + wx * vy / w2]
    )
    # |v| / |w| up to 2e3 m, with the roundings of a dozen products.
    assert line_distance_m(point, axis.point_m, axis.direction) < 1e-9


def test_angle_between_lines_has_no_sense_and_no_lengths():
    assert line_angle_rad([0, 0, 2], [0, 0, -5]) == 0.0
    assert line_angle_rad([1, 0, 0], [0, 3, 0]) == pytest.approx(np.pi / 2)
    assert line_angle_rad([1, 0, 0], [-1, 1e-9, 0]) == pytest.approx(1e-9, rel=1e-6)
