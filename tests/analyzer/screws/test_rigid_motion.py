"""Rigid motion by least squares: the truth, its scatter, and when it cannot be had."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from scipy import stats
from support.draws import generators

from armodal.analyzer.screws import mozzi_axis, rigid_motion

TWIST = np.array([0.02, -0.01, 0.03, 0.4, -0.2, 1.0])


def cloud(rng, n=8):
    """Points of an arm's size with three measured directions each, and the design by hand."""
    points = np.repeat(rng.uniform(-0.3, 0.5, (n, 3)), 3, axis=0)
    turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0].T for _ in range(n)]
    directions = np.concatenate(turns)
    # d . (v + w x p) = d . v + (p x d) . w
    return points, directions, np.hstack([directions, np.cross(points, directions)])


def test_noise_alone_is_explained_by_its_share_of_freedoms():
    rng = np.random.default_rng(3)
    points, directions, _ = cloud(rng)
    shares = [rigid_motion(points, directions, rng.normal(size=24)).explained for _ in range(400)]
    # Six of 24 directions: a beta distribution of 3 and 9.
    mean, std = stats.beta(3, 9).stats()[0], np.sqrt(stats.beta(3, 9).stats()[1])
    assert np.mean(shares) == pytest.approx(mean, abs=5 * std / np.sqrt(400))


@settings(max_examples=20)
@given(generators)
def test_any_three_points_of_a_rigid_body_show_one_axis(rng):
    # File 000, Eq. (10) and Table 5: six groups of three points.
    points, directions, design = cloud(rng, n=5)
    motion = design @ TWIST
    truth = mozzi_axis(TWIST)
    for three in combinations(range(5), 3):
        rows = np.concatenate([np.arange(3 * i, 3 * i + 3) for i in three])
        condition = np.linalg.cond(design[rows])
        if condition > 1e4:  # three points nearly in line tell no turn about it
            continue
        axis = mozzi_axis(rigid_motion(points[rows], directions[rows], motion[rows]).twist.real)
        # Rounding, times the condition of the points.
        np.testing.assert_allclose(axis.direction, truth.direction, atol=1e-14 * condition)
        np.testing.assert_allclose(axis.point_m, truth.point_m, atol=1e-14 * condition)


@settings(max_examples=20)
@given(generators)
def test_where_the_frame_stands_does_not_matter(rng):
    points, directions, design = cloud(rng)
    shift = np.array([3.0, -2.0, 1.0])
    motion = design @ TWIST
    there = mozzi_axis(rigid_motion(points + shift, directions, motion).twist.real)
    here = mozzi_axis(rigid_motion(points, directions, motion).twist.real)
    moved = here.point_m + shift
    moved = moved - here.direction * (here.direction @ moved)
    # Rounding: eight points of half a metre, four metres away.
    np.testing.assert_allclose(there.point_m, moved, atol=1e-11)


def test_points_all_at_rest_move_by_nothing():
    points, directions, _ = cloud(np.random.default_rng(1))
    found = rigid_motion(points, directions, np.zeros(24))
    np.testing.assert_array_equal(found.twist, np.zeros(6))
    assert found.explained == 0.0
