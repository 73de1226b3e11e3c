"""Twists, Mozzi axes and rigid motions against what is known of them exactly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.draws import generators

from armodal.analyzer.screws import (
    MozziAxis,
    Translation,
    line_angle_rad,
    line_distance_m,
    mozzi_axis,
    rigid_motion,
)
from armodal.protocols.errors import EstimateError

numbers = st.floats(-2.0, 2.0, allow_nan=False)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


@given(vectors, vectors, st.floats(-0.5, 0.5), st.floats(1e-3, 10.0))
def test_a_twist_made_from_an_axis_gives_the_axis_back(direction, point, pitch, rotation):
    length = np.linalg.norm(direction)
    assume(length > 1e-2)
    u = direction / length
    linear = rotation * (np.cross(point, u) + pitch * u)
    axis = mozzi_axis(np.concatenate([linear, rotation * u]))
    assert isinstance(axis, MozziAxis)
    # Rounding of products of numbers up to 20, divided by the rotation squared.
    tolerance = 1e-11 / min(rotation, 1.0)
    np.testing.assert_allclose(axis.direction, u, atol=1e-12)
    assert line_distance_m(point, axis.point_m, axis.direction) < tolerance
    assert axis.pitch_m_per_rad == pytest.approx(pitch, abs=tolerance)
    assert axis.rotation == pytest.approx(rotation, rel=1e-12)
    assert abs(axis.point_m @ axis.direction) < tolerance  # the point nearest the origin


@given(vectors, vectors, vectors)
def test_points_of_the_axis_move_along_it_only(linear, angular, offset):
    assume(np.linalg.norm(angular) > 1e-2)
    axis = mozzi_axis(np.concatenate([linear, angular]))
    assert isinstance(axis, MozziAxis)
    there = axis.point_m + (offset @ axis.direction) * axis.direction
    velocity = linear + np.cross(angular, there)
    across = velocity - axis.direction * (axis.direction @ velocity)
    assert np.linalg.norm(across) < 1e-9  # rounding over rotations down to a hundredth


@given(vectors)
def test_a_motion_without_rotation_is_a_translation(linear):
    motion = mozzi_axis(np.concatenate([linear, np.zeros(3)]))
    assert isinstance(motion, Translation)
    np.testing.assert_array_equal(motion.displacement, linear)


@given(vectors, vectors, st.floats(-5, 5))
def test_distance_and_angle_of_lines_do_not_depend_on_how_a_line_is_written(u, p, along):
    assume(np.linalg.norm(u) > 1e-2)
    point = np.array([0.3, -0.2, 0.7])
    a = line_distance_m(point, p, u)
    b = line_distance_m(point, p + along * u, -3.0 * u)
    assert a == pytest.approx(b, abs=1e-9)
    assert line_angle_rad(u, -2.0 * u) == pytest.approx(0.0, abs=1e-7)


def cloud(n, rng):
    points = rng.normal(size=(n, 3)) + np.array([0.5, 0.0, 1.0])
    return np.repeat(points, 3, axis=0), np.tile(np.eye(3), (n, 1))


def design_of(points, directions):
    return np.hstack([directions, np.cross(points, directions)])


def moved(points, directions, twist):
    velocity = twist[:3] + np.cross(twist[3:], points)
    return (directions * velocity).sum(axis=1)


@given(generators)
def test_a_rigid_motion_is_found_exactly_from_three_points(rng):
    points, directions = cloud(3, rng)
    condition = np.linalg.cond(design_of(points, directions))
    assume(condition < 1e3)  # three points nearly in line tell no turn about it
    twist = rng.normal(size=6) + 1j * rng.normal(size=6)
    found = rigid_motion(points, directions, moved(points, directions, twist))
    # Rounding, times the condition of the points.
    np.testing.assert_allclose(found.twist, twist, atol=1e-14 * condition)
    assert found.explained == pytest.approx(1.0, abs=1e-12)


def test_noise_moves_the_twist_by_what_least_squares_says():
    """Scatter of the estimate against sigma² (AᵀA)⁻¹, the design written out here."""
    rng = np.random.default_rng(1)
    points, directions = cloud(6, rng)
    twist = rng.normal(size=6)
    design = design_of(points, directions)
    sigma = 0.01
    clean = moved(points, directions, twist)
    n = 800
    found = np.array(
        [
            rigid_motion(points, directions, clean + sigma * rng.normal(size=clean.size)).twist.real
            for _ in range(n)
        ]
    )
    expected = sigma * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    # A standard deviation of 800 draws strays by 2.5 %; five times that is allowed.
    np.testing.assert_allclose(found.std(axis=0), expected, rtol=0.125)


@given(generators)
def test_the_part_that_is_not_rigid_is_told(rng):
    points, directions = cloud(5, rng)
    twist = rng.normal(size=6)
    rigid = moved(points, directions, twist)
    design = design_of(points, directions)
    assume(np.linalg.cond(design) < 1e3)
    bent = rng.normal(size=rigid.size)
    bent -= design @ np.linalg.lstsq(design, bent, rcond=None)[0]
    bent *= 0.5 * np.linalg.norm(rigid) / np.linalg.norm(bent)
    found = rigid_motion(points, directions, rigid + bent)
    # The bent part is orthogonal to every rigid motion: 1 / (1 + 0.25) of the square is rigid.
    assert found.explained == pytest.approx(0.8, abs=1e-9)
    np.testing.assert_allclose(found.twist.real, twist, atol=1e-9)


def test_points_in_line_leave_the_motion_undetermined():
    points = np.repeat(np.outer([0.0, 1.0, 2.0], [1.0, 0.5, 0.2]), 3, axis=0)
    with pytest.raises(EstimateError, match="not in line"):
        rigid_motion(points, np.tile(np.eye(3), (3, 1)), np.ones(9))


def test_too_few_directions_are_said():
    with pytest.raises(EstimateError, match="at least 6"):
        rigid_motion(np.zeros((5, 3)), np.ones((5, 3)), np.ones(5))
