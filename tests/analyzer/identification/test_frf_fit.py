"""The fit to FRFs: truth without noise, intervals with it, and what does not converge."""

from dataclasses import replace

import numpy as np
import pytest
from support.small_fit import measured, state_of, true_axis, true_structure, unmeasured

from armodal.analyzer.identification.frf_fit import fit_frfs, line_weights, normal_equations
from armodal.analyzer.identification.frf_model import predict
from armodal.analyzer.identification.parameters import FitState, step_state
from armodal.analyzer.identification.scatter import half_width_95
from armodal.analyzer.screws import line_angle_rad, line_distance_m
from armodal.protocols.errors import EstimateError

FREQ_HZ = np.linspace(5, 60, 14)
POINTS = ("1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12")


def problem(superset, structure, freq_hz=FREQ_HZ, tests=(0, 1, 2)):
    """Noise-free postures and the state they come from."""
    state = state_of(structure, len(tests))
    blanks = [unmeasured(superset, test, POINTS, freq_hz) for test in tests]
    return tuple(measured(superset, d, state, i) for i, d in enumerate(blanks)), state


def test_without_noise_the_truth_is_found_from_first_guesses(superset):
    data, truth = problem(superset, true_structure())
    guess = replace(
        truth.structure,
        stiffness_n_m_per_rad=truth.structure.stiffness_n_m_per_rad * [0.75, 1.3, 0.8],
        damping_n_m_s_per_rad=truth.structure.damping_n_m_s_per_rad * [1.5, 0.6, 1.4],
    )
    fit = fit_frfs(superset, data, state_of(guess, 3))
    # The iteration stops when its steps promise 1e-9 of the cost or 1e-6 in all.
    found = fit.state.structure
    np.testing.assert_allclose(found.all_stiffness(), truth.structure.all_stiffness(), rtol=1e-6)
    np.testing.assert_allclose(found.all_damping(), truth.structure.all_damping(), rtol=1e-5)
    assert fit.relative_residual.max() < 1e-5


def test_without_noise_the_axis_is_found_from_a_neighbouring_one(superset):
    axis = true_axis()
    data, truth = problem(superset, true_structure([axis]), np.linspace(5, 110, 22), tests=(0, 2))
    step = np.zeros(6 + 6 + 3 + 4)
    step[6:10] = [0.1, -0.1, 0.02, 0.02]
    step[10] = 0.2
    fit = fit_frfs(superset, data, step_state(truth, step))
    (found,) = fit.state.structure.axes
    assert line_angle_rad(found.direction, axis.direction) < 1e-6
    assert line_distance_m(axis.point_m, found.point_m, found.direction) < 1e-6
    assert found.stiffness_n_m_per_rad == pytest.approx(axis.stiffness_n_m_per_rad, rel=1e-5)


def test_the_gradient_is_that_of_the_cost(superset):
    data, truth = problem(superset, true_structure())
    weights = tuple(line_weights(d) for d in data)
    at = step_state(truth, np.full(6 + 3 + 6, 0.03))

    def cost(step):
        state = step_state(at, step)
        return sum(
            0.5 * float((w * np.abs(d.values - predict(superset, d, state, i)) ** 2).sum())
            for i, (d, w) in enumerate(zip(data, weights, strict=True))
        )

    normal = normal_equations(superset, data, weights, at)
    assert normal.cost == pytest.approx(cost(np.zeros(15)), rel=1e-12)
    h = 1e-5
    slope = [(cost(h * unit) - cost(-h * unit)) / (2 * h) for unit in np.eye(15)]
    # Central differences: h² of third derivatives, rounding of cost / h = 1e-11 of it.
    np.testing.assert_allclose(-normal.gradient, slope, atol=1e-6 * np.abs(slope).max())
    np.testing.assert_allclose(normal.cluster_g.sum(axis=0), normal.gradient)
    np.testing.assert_allclose(normal.cluster_hessian.sum(axis=0), normal.H)


@pytest.mark.long
def test_intervals_cover_the_truth_as_often_as_they_say(superset):
    """Two postures, twelve mountings each: sensor tilts of half a degree, two per cent noise."""
    clean, truth = problem(superset, true_structure(), tests=(0, 2))
    rng = np.random.default_rng(1)
    seeds, inside, errors = 60, [], []
    for _ in range(seeds):
        tilts = np.deg2rad(1.0) * rng.normal(size=(2, 2))
        gains = 0.01 * rng.normal(size=3)
        actual = FitState(structure=truth.structure, log_gain=gains, hit_tilt_rad=tilts)
        data = tuple(
            measured(superset, d, actual, i, rng, noise=0.02, tilt_rad=np.deg2rad(0.5))
            for i, d in enumerate(clean)
        )
        fit = fit_frfs(superset, data, truth)
        std, dof = fit.scatter.std(), fit.scatter.degrees_of_freedom()
        found = np.log([*fit.state.structure.all_stiffness(), *fit.state.structure.all_damping()])
        true = np.log([*truth.structure.all_stiffness(), *truth.structure.all_damping()])
        errors.append(found - true)
        widths = [half_width_95(s, nu) for s, nu in zip(std[:6], dof[:6], strict=True)]
        inside.append(np.abs(found - true) <= widths)
    # Six parameters of one seed are not independent: the binomial is that of the seeds alone.
    spread = np.sqrt(0.95 * 0.05 / seeds)
    assert np.mean(inside) == pytest.approx(0.95, abs=3 * spread)
    assert np.mean(inside, axis=0).min() > 0.95 - 4 * spread
    # No bias: the mean error within 4.5 of its standard deviations.
    bias = np.mean(errors, axis=0) / (np.std(errors, axis=0) / np.sqrt(seeds))
    assert np.abs(bias).max() < 4.5


def test_a_prior_holds_what_the_data_do_not_say(arm, superset):
    state = state_of(true_structure(), 1)
    blank = unmeasured(superset, 0, ("1", "5", "9", "12"), FREQ_HZ)
    data = measured(superset, blank, state, 0, np.random.default_rng(2), noise=30.0)
    fit = fit_frfs(superset, (data,), state, max_iterations=200)
    gains = slice(-5, -2)
    # Noise of thirty times the signal cannot say a gain to two per cent.
    np.testing.assert_allclose(
        np.sqrt(np.diag(fit.scatter.covariance))[gains], fit.parameters.prior_std[gains], rtol=0.05
    )


def test_weights_allow_for_what_mountings_do(superset):
    data, _ = problem(superset, true_structure(), tests=(0,))
    motion = (np.abs(data[0].values) ** 2).sum(axis=2, keepdims=True)
    # Half a degree turns one axis into another by a hundredth.
    np.testing.assert_allclose(
        1 / line_weights(data[0]), data[0].variance + 1e-4 * motion, rtol=1e-12
    )


def test_a_point_that_does_not_move_has_a_finite_weight(superset):
    blank = unmeasured(superset, 0, ("1", "18"), FREQ_HZ)
    data = measured(superset, blank, state_of(true_structure(), 1), 0)
    silent = replace(data, variance=np.zeros_like(data.variance))
    assert np.isfinite(line_weights(silent)).all()


def test_a_fit_cut_short_says_so_and_hands_over_what_it_has(superset):
    data, truth = problem(superset, true_structure(), tests=(0,))
    far = step_state(truth, np.r_[np.full(6, 0.5), np.zeros(5)])
    with pytest.raises(EstimateError, match="did not converge in 2 iterations") as caught:
        fit_frfs(superset, data, far, max_iterations=2)
    assert caught.value.partial.iterations == 2
    assert np.isfinite(caught.value.partial.cost)


def test_a_fit_that_another_has_beaten_is_given_up_before_it_converges(superset):
    data, _ = problem(superset, true_structure([true_axis()]), np.linspace(5, 110, 22))
    lacking = state_of(true_structure(), 3)  # without the axis it cannot come near the truth
    whole = fit_frfs(superset, data, lacking)
    early = fit_frfs(superset, data, lacking, beaten=whole.cost / 10.0)
    assert early.iterations < whole.iterations
    assert early.cost >= whole.cost
    # What it could still beat is fitted to the end.
    again = fit_frfs(superset, data, lacking, beaten=2.0 * whole.cost)
    assert again.cost == whole.cost
