"""Stiffness from frequencies alone against file 002, Eq. (13), minimised here."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
from support.made_modes import dofs_of, made_modes, mode_of
from support.plain_arm import TESTS_DEG
from support.small_fit import true_axis, true_structure

from armodal.analyzer.arm import reduce_model
from armodal.analyzer.identification.mode_fit import (
    MeasuredModes,
    fit_to_frequencies,
    pair_by_shape,
)
from armodal.protocols.errors import EstimateError

POSTURES = [np.deg2rad(q) for q in TESTS_DEG]


def undamped(structure):
    """The structure with hardly any damping, so that |pole| is the undamped frequency."""
    return replace(structure, damping_n_m_s_per_rad=np.full(len(structure.joints), 1e-6))


def guessed(structure, factors):
    return replace(structure, stiffness_n_m_per_rad=structure.stiffness_n_m_per_rad * factors)


def frequencies_hz(superset, dynamics, structure):
    model = reduce_model(superset, dynamics, structure)
    return np.sqrt(scipy.linalg.eigh(model.stiffness, model.mass, eigvals_only=True)) / (2 * np.pi)


def test_the_minimum_of_equation_thirteen_is_found(superset):
    truth = undamped(true_structure())
    measured = tuple(made_modes(superset, q, truth) for q in POSTURES)
    guess = guessed(truth, [0.7, 1.35, 0.75])
    found = fit_to_frequencies(superset, guess, measured, prior_std=100.0)
    # A prior of 100 on ln k against one per cent of a frequency pulls by (0.02 / 100)².
    np.testing.assert_allclose(found.stiffness_n_m_per_rad, truth.stiffness_n_m_per_rad, rtol=1e-6)

    def penalty(log_k):
        """File 002, Eq. (13), modes in order of frequency."""
        structure = replace(truth, stiffness_n_m_per_rad=np.exp(log_k))
        return sum(
            np.sum(
                (
                    np.array([mode.f_hz for mode in m.modes])
                    - frequencies_hz(superset, m.dynamics, structure)
                )
                ** 2
            )
            for m in measured
        )

    best = scipy.optimize.minimize(
        penalty,
        np.log(found.stiffness_n_m_per_rad) + 0.05,
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-18, "maxiter": 2000},
    )
    np.testing.assert_allclose(np.exp(best.x), found.stiffness_n_m_per_rad, rtol=1e-5)


def test_the_prior_pulls_a_first_guess_by_less_than_a_hundredth(superset):
    truth = undamped(true_structure())
    measured = tuple(made_modes(superset, q, truth) for q in POSTURES)
    found = fit_to_frequencies(superset, guessed(truth, [0.7, 1.35, 0.75]), measured)
    # (0.02 / 0.4)² of a log of 0.35, for the spring that one mode alone determines.
    error = np.log(found.stiffness_n_m_per_rad / truth.stiffness_n_m_per_rad)
    assert np.abs(error).max() < 0.01


def test_a_spring_that_no_mode_strains_stays_where_it_was(superset):
    truth = undamped(true_structure())
    whole = made_modes(superset, POSTURES[0], truth)
    # In test 1 the mode of joint 1 is alone in its direction.
    share = joint_one_share(superset, whole, truth)
    number = int(np.argmax(share))
    only = MeasuredModes(superset, whole.dynamics, (whole.modes[number],), dofs(superset, whole))
    guess = guessed(truth, [0.7, 1.35, 0.75])
    found = fit_to_frequencies(superset, guess, (only,))
    assert found.stiffness_n_m_per_rad[0] == pytest.approx(20789.0, rel=0.02)
    np.testing.assert_allclose(
        found.stiffness_n_m_per_rad[1:], guess.stiffness_n_m_per_rad[1:], rtol=0.02
    )


def joint_one_share(superset, measured, structure):
    model = reduce_model(superset, measured.dynamics, structure)
    squares, vectors = scipy.linalg.eigh(model.stiffness, model.mass)
    return structure.stiffness_n_m_per_rad[0] * vectors[0] ** 2 / squares


def dofs(superset, measured):
    return dofs_of(superset, measured.dynamics)


def test_a_mode_the_structure_cannot_make_has_no_say(superset):
    truth = undamped(true_structure())
    clean = made_modes(superset, POSTURES[0], truth)
    rng = np.random.default_rng(1)
    rows = clean.rows(reduce_model(superset, clean.dynamics, truth).point_jacobian)
    # A shape at right angles to all that the joints can do: MAC 0 with every model mode.
    foreign = rng.normal(size=len(rows))
    foreign -= rows @ np.linalg.lstsq(rows, foreign, rcond=None)[0]
    dirty = MeasuredModes(
        superset,
        clean.dynamics,
        (*clean.modes, mode_of(-1.0 + 2j * np.pi * 17.0, foreign)),
        dofs(superset, clean),
    )
    guess = guessed(truth, [0.8, 1.2, 0.8])
    with_it = fit_to_frequencies(superset, guess, (dirty,))
    without = fit_to_frequencies(superset, guess, (clean,))
    np.testing.assert_allclose(
        with_it.stiffness_n_m_per_rad, without.stiffness_n_m_per_rad, rtol=1e-9
    )


def test_stiffnesses_below_gravitys_are_refused_with_their_unit(superset):
    truth = undamped(true_structure())
    measured = tuple(made_modes(superset, q, truth) for q in POSTURES)
    in_kilo = guessed(truth, 1e-3)
    with pytest.raises(EstimateError, match=r"joint_2 24\.3.* N m/rad: correct .* arm file"):
        fit_to_frequencies(superset, in_kilo, measured)


def test_the_axis_takes_part(superset):
    truth = undamped(true_structure([replace(true_axis(), damping_n_m_s_per_rad=1e-6)]))
    measured = tuple(made_modes(superset, q, truth) for q in POSTURES)
    (axis,) = truth.axes
    guess = replace(truth, axes=(replace(axis, stiffness_n_m_per_rad=60000.0),))
    found = fit_to_frequencies(superset, guess, measured, prior_std=100.0)
    assert found.axes[0].stiffness_n_m_per_rad == pytest.approx(89000.0, rel=1e-6)
    alone = replace(
        guess,
        joints=(),
        stiffness_n_m_per_rad=np.zeros(0),
        damping_n_m_s_per_rad=np.zeros(0),
    )
    one = made_modes(superset, POSTURES[0], replace(alone, axes=truth.axes))
    assert fit_to_frequencies(superset, alone, (one,), prior_std=100.0).axes[
        0
    ].stiffness_n_m_per_rad == pytest.approx(89000.0, rel=1e-6)


def test_a_posture_without_modes_says_nothing(superset):
    truth = undamped(true_structure())
    empty = MeasuredModes(superset, superset.posture(POSTURES[1]), (), ())
    assert empty.shapes.shape == (0, 0)
    measured = made_modes(superset, POSTURES[0], truth)
    silent = MeasuredModes(superset, measured.dynamics, (), dofs(superset, measured))
    guess = guessed(truth, [0.8, 1.2, 0.8])
    both = fit_to_frequencies(superset, guess, (measured, silent))
    one = fit_to_frequencies(superset, guess, (measured,))
    np.testing.assert_allclose(both.stiffness_n_m_per_rad, one.stiffness_n_m_per_rad, rtol=1e-12)


def test_the_slope_of_a_frequency_is_the_springs_share_of_strain_energy(superset):
    structure = true_structure([true_axis()])
    dynamics = superset.posture(POSTURES[2])
    model = reduce_model(superset, dynamics, structure)
    squares, vectors = scipy.linalg.eigh(model.stiffness, model.mass)
    h = 1e-5
    for j in range(3):
        factor = np.where(np.arange(3) == j, h, 0.0)
        ahead = frequencies_hz(superset, dynamics, guessed(structure, np.exp(factor)))
        behind = frequencies_hz(superset, dynamics, guessed(structure, np.exp(-factor)))
        share = structure.stiffness_n_m_per_rad[j] * vectors[j] ** 2 / squares
        np.testing.assert_allclose(2 * np.log(ahead / behind) / (2 * h), share, atol=1e-8)


def test_pairs_do_not_depend_on_order_scale_or_phase():
    rng = np.random.default_rng(3)
    shapes = rng.normal(size=(20, 4)) + 1j * rng.normal(size=(20, 4))
    order = [2, 0, 3, 1]
    other = shapes[:, order] * [1j, -2.0, 0.1, 3.0 - 1j]
    for i, j, mac in pair_by_shape(shapes, other):
        assert order[j] == i
        assert mac == pytest.approx(1.0)


def test_pairs_are_one_to_one_for_the_largest_sum():
    # Greedy pairing would take (0, 0) first and leave (1, 1) at right angles.
    measured = np.eye(3)[:, :2]
    model = np.column_stack([[0.8, 0.6, 0.0], [0.75, 0.0, np.sqrt(1 - 0.75**2)]])
    pairs = {(i, j) for i, j, _ in pair_by_shape(measured, model)}
    assert pairs == {(0, 1), (1, 0)}
