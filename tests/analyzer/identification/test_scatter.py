"""Scatter between clusters against what is known exactly for a mean, and of one mounting."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.small_fit import measured, state_of, true_structure, unmeasured

from armodal.analyzer.identification.frf_fit import fit_frfs
from armodal.analyzer.identification.result_rows import fit_notes
from armodal.analyzer.identification.scatter import ParameterScatter, half_width_95


def mean_scatter(values: np.ndarray) -> ParameterScatter:
    """Scatter of the mean of equal clusters, as a weighted fit of one parameter sees it."""
    residual = values - values.mean()
    return ParameterScatter.of(
        np.full((len(values), 1, 1), 7.0), 7.0 * residual[:, None], np.array([np.inf])
    )


def test_the_variance_of_a_mean_is_that_of_the_textbook():
    values = np.random.default_rng(1).normal(size=9)
    scatter = mean_scatter(values)
    assert scatter.covariance[0, 0] == pytest.approx(values.var(ddof=1) / 9, rel=1e-12)
    assert scatter.degrees_of_freedom()[0] == pytest.approx(8.0, rel=1e-12)


@pytest.mark.long
def test_the_95_interval_of_a_mean_covers_it_95_times_in_100():
    rng = np.random.default_rng(2)
    n, inside = 4000, 0
    for _ in range(n):
        values = rng.normal(size=6)
        scatter = mean_scatter(values)
        width = half_width_95(scatter.std()[0], scatter.degrees_of_freedom()[0])
        inside += abs(values.mean()) <= width
    # Exact for normal clusters: a binomial of 0.95, within four of its standard deviations.
    assert abs(inside / n - 0.95) < 4 * np.sqrt(0.95 * 0.05 / n)


def test_the_stated_std_is_that_of_a_student_t():
    values = np.random.default_rng(3).normal(size=7)
    scatter = mean_scatter(values)
    textbook = np.sqrt(values.var(ddof=1) / 7)
    assert scatter.std()[0] == pytest.approx(textbook * np.sqrt(6.0 / 4.0), rel=1e-12)


def test_one_strong_cluster_leaves_few_degrees_of_freedom():
    hessian = np.array([100.0, 1.0, 1.0, 1.0])[:, None, None]
    scatter = ParameterScatter.of(hessian, np.zeros((4, 1)), np.array([np.inf]))
    assert scatter.degrees_of_freedom()[0] == 1.0


def test_a_combination_has_the_variance_of_its_parts():
    rng = np.random.default_rng(4)
    J = rng.normal(size=(12, 8, 3))
    hessian = np.einsum("cla,clb->cab", J, J)
    residual = rng.normal(size=(12, 8))
    scatter = ParameterScatter.of(hessian, np.einsum("cla,cl->ca", J, residual), np.full(3, 10.0))
    unit = np.eye(3)
    np.testing.assert_allclose(scatter.std(unit), scatter.std(), rtol=1e-12)
    doubled = np.array([[2.0], [0.0], [0.0]])
    assert scatter.std(doubled)[0] == pytest.approx(2 * scatter.std()[0], rel=1e-12)


@pytest.mark.parametrize("points", [("4",), ("4", "17", "18")])  # 17 and 18 are on the base
def test_the_error_from_one_mounting_is_within_what_is_stated(superset, points):
    truth = true_structure()
    log_truth = np.log(np.r_[truth.all_stiffness(), truth.all_damping()])
    # Of a posture with a mode of each joint.
    blank = unmeasured(superset, 1, points, np.arange(8.0, 60.0, 1.0))
    ratios = []
    for seed in range(16):
        rng = np.random.default_rng(seed)
        state = replace(state_of(truth, 1), log_gain=0.01 * rng.normal(size=3))
        data = measured(superset, blank, state, 0, rng, noise=0.01, tilt_rad=0.009)
        fit = fit_frfs(superset, (data,), state_of(truth, 1))
        found = fit.state.structure
        error = np.log(np.r_[found.all_stiffness(), found.all_damping()]) - log_truth
        ratios.append(error / fit.scatter.std()[:6])
        assert fit.scatter.one_mounting
    size = np.sqrt(np.mean(np.square(ratios), axis=0))
    # 16 errors tell their size to 18 %: three times that above one. Weights count noise twice
    # and a tilt as noise of every line, so the stated std may be several times the error.
    assert np.all(size < 1.54)
    assert np.all(size > 0.05)


def test_a_note_says_that_one_mounting_shows_no_scatter(superset):
    truth = true_structure(joints=(0,))
    blank = unmeasured(superset, 0, ("4", "8"), np.arange(8.0, 30.0, 1.0))
    both = measured(superset, blank, state_of(truth, 1), 0)
    one = replace(
        both,
        sensor_point=both.sensor_point[:1],
        values=both.values[:1],
        variance=both.variance[:1],
    )
    told = []
    for data in (one, both):
        fit = fit_frfs(superset, (data,), state_of(truth, 1))
        notes = fit_notes(fit, (SimpleNamespace(posture="p"),), [[1.0]], ())
        told.append(any("on one mounting alone" in note for note in notes))
    assert told == [True, False]
