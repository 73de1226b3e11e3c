"""Predicted modes and what the fit's covariance makes of them."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from support.made_fits import made_fit
from support.plain_arm import TESTS_DEG
from support.small_fit import true_axis, true_structure

from armodal.analyzer.arm import reduce_model
from armodal.analyzer.identification.prediction import predict_modes

Q = np.deg2rad(TESTS_DEG[1])
SPREAD = np.sqrt(10 / 8)  # of a Student t with ten degrees of freedom


def nothing(superset):
    return np.zeros(len(superset.arm.points))


def test_one_joint_has_the_closed_form(superset):
    """f ~ sqrt(k + g), zeta = c / (2 sqrt((k + g) I)), with independent ln k and ln c."""
    structure = true_structure(joints=(1,))
    std_k, std_c = 0.02, 0.1
    covariance = np.diag([std_k**2, std_c**2, 0, 0, 0, 0, 0])
    fit = made_fit(superset, structure, covariance)
    dynamics = superset.posture(Q)
    found = predict_modes(superset, dynamics, fit, added_mass_kg=nothing(superset))
    column = superset.joint_column(1)
    inertia, g = dynamics.mass[column, column], dynamics.gravity_stiffness[column, column]
    k, c = 24307.0, 8.46
    f = np.sqrt((k + g) / inertia) / (2 * np.pi)
    zeta = c / (2 * np.sqrt((k + g) * inertia))
    share = k / (k + g)
    assert found.modes.f_hz[0] == pytest.approx(f, rel=1e-9)
    # Slopes by central differences: 1e-10 of truncation, 1e-16 / 1e-5 of rounding.
    assert found.f_std_hz[0] == pytest.approx(f / 2 * share * std_k * SPREAD, rel=1e-6)
    damping_std = zeta * np.hypot(std_c, share / 2 * std_k) * SPREAD
    assert found.damping_std[0] == pytest.approx(damping_std, rel=1e-5)
    assert found.f_dof[0] == pytest.approx(10)


def test_slopes_of_frequencies_are_shares_of_strain_energy(superset):
    # Without damping, so that |pole| is the frequency of the undamped modes.
    structure = replace(
        true_structure([replace(true_axis(), damping_n_m_s_per_rad=1e-6)]),
        damping_n_m_s_per_rad=np.full(3, 1e-6),
    )
    names = made_fit(superset, structure).parameters.names
    dynamics = superset.posture(Q)
    model = reduce_model(superset, dynamics, structure)
    squares, vectors = scipy.linalg.eigh(model.stiffness, model.mass)
    for spring, name in enumerate(["ln k joint_1", "ln k joint_2", "ln k joint_3", "ln k axis 1"]):
        covariance = np.zeros((len(names), len(names)))
        covariance[names.index(name), names.index(name)] = 0.01**2
        fit = made_fit(superset, structure, covariance)
        found = predict_modes(superset, dynamics, fit, added_mass_kg=nothing(superset))
        share = structure.all_stiffness()[spring] * vectors[spring] ** 2 / squares
        expected = found.modes.f_hz / 2 * share * 0.01 * SPREAD
        np.testing.assert_allclose(found.f_std_hz, expected, atol=1e-6 * expected.max())
    energy = structure.all_stiffness()[:, None] * vectors**2
    np.testing.assert_allclose(found.strain_share, energy / energy.sum(axis=0), atol=1e-6)


def test_fully_correlated_springs_move_frequencies_together(superset):
    """All springs by one factor: every frequency by half its logarithm, gravity apart."""
    structure = true_structure([true_axis()])
    names = made_fit(superset, structure).parameters.names
    common = np.array([name.startswith("ln ") and " gain" not in name for name in names]) * 0.02
    fit = made_fit(superset, structure, np.outer(common, common))
    dynamics = superset.posture(Q)
    found = predict_modes(superset, dynamics, fit, added_mass_kg=nothing(superset))
    # Gravity's -42 N m/rad of 24307 do not scale.
    np.testing.assert_allclose(found.f_std_hz, found.modes.f_hz * 0.01 * SPREAD, rtol=0.005)


def test_nuisances_of_the_sensors_move_no_frequency(superset):
    structure = true_structure()
    names = made_fit(superset, structure).parameters.names
    nuisance = np.array(["gain" in name or "tilt" in name for name in names])
    fit = made_fit(superset, structure, np.diag(nuisance * 1.0))
    found = predict_modes(superset, superset.posture(Q), fit, added_mass_kg=nothing(superset))
    np.testing.assert_array_equal(found.f_std_hz, np.zeros(3))


def test_a_riding_sensor_lowers_every_frequency_a_little(superset):
    fit = made_fit(superset, true_structure())
    dynamics = superset.posture(Q)
    bare = predict_modes(superset, dynamics, fit, added_mass_kg=nothing(superset))
    mass = nothing(superset)
    mass[superset.point_index["1"]] = 0.0093
    loaded = predict_modes(superset, dynamics, fit, added_mass_kg=mass)
    drop = 1 - loaded.modes.f_hz / bare.modes.f_hz
    # By Rayleigh a point mass can only lower frequencies; 9.3 g on 20 kg by less than 0.5 %.
    assert (drop >= -1e-12).all()
    assert 0 < drop.max() < 0.005
