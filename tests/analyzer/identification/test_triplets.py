from __future__ import annotations

import numpy as np
import pytest

from armodal.analyzer.identification.triplets import triplet_axes
from armodal.analyzer.screws import line_angle_rad, line_distance_m

DIRECTION = np.array([0.0, 0.6, 0.8])
POINT = np.array([0.1, -0.2, 0.15])


def turning(points, noise=0.0, seed=1):
    rng = np.random.default_rng(seed)
    motion = np.cross(DIRECTION, points - POINT) * np.exp(0.7j)
    return motion + noise * (rng.normal(size=points.shape) + 1j * rng.normal(size=points.shape))


def cloud(n=8):
    return np.random.default_rng(2).uniform(-0.5, 0.5, size=(n, 3))


def test_a_rigid_body_gives_one_axis_from_all_triplets():
    points = cloud()
    found = triplet_axes(points, turning(points))
    assert line_angle_rad(found.direction, DIRECTION) < 1e-9
    assert line_distance_m(POINT, found.point_m, found.direction) < 1e-9
    assert found.angle_rms_deg < 1e-6
    assert found.distance_rms_m < 1e-9
    assert found.n_triplets > 20


def test_scatter_grows_with_the_noise_and_says_how_far_the_average_may_be_off():
    points = cloud(10)
    small, large = (triplet_axes(points, turning(points, noise)) for noise in (1e-3, 1e-2))
    # Ten times the noise: ten times the scatter, as long as the map is linear; half is allowed.
    assert large.angle_rms_deg == pytest.approx(10 * small.angle_rms_deg, rel=0.5)
    off = np.rad2deg(line_angle_rad(large.direction, DIRECTION))
    assert off < large.angle_rms_deg


def test_points_in_line_give_no_axis():
    points = np.outer(np.linspace(0, 1, 5), [1.0, 0.5, 0.2])
    assert triplet_axes(points, turning(points)) is None


def test_a_translation_gives_no_axis():
    points = cloud()
    assert triplet_axes(points, np.tile([1.0 + 0j, 2.0, 0.0], (8, 1))) is None
