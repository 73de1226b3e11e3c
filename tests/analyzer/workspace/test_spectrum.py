from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints, elastic_joints, spectrum
from armodal.protocols.errors import ArmError


@pytest.fixture(scope="module")
def five():
    return ElasticJoints(
        joints=(0, 1, 2, 3, 4),
        stiffness_n_m_per_rad=np.array([2.1e4, 2.4e4, 2.1e4, 4.0e3, 3.0e3]),
        damping_n_m_s_per_rad=np.array([15.0, 8.0, 6.0, 0.4, 0.2]),
    )


@pytest.fixture(scope="module")
def joints_rad(arm):
    return np.random.default_rng(3).uniform(-3, 3, size=(30, len(arm.joints)))


def test_frequencies_are_the_generalised_eigenvalues(arm, five, joints_rad):
    mass = ArmBatch(arm).mass(joints_rad)
    found = spectrum(ArmBatch(arm), joints_rad, five)
    for i in range(len(joints_rad)):
        M = mass[np.ix_(five.joints, five.joints, [i])][..., 0]
        square = scipy.linalg.eigh(np.diag(five.stiffness_n_m_per_rad), M, eigvals_only=True)
        # Both solvers lose about the ratio of largest to smallest eigenvalue, below 1e4.
        np.testing.assert_allclose(found.f_hz[i], np.sqrt(square) / (2 * np.pi), rtol=1e-10)


def test_shapes_have_unit_modal_mass_and_diagonal_stiffness(arm, five, joints_rad):
    mass = ArmBatch(arm).mass(joints_rad)
    found = spectrum(ArmBatch(arm), joints_rad, five)
    for i, shape in enumerate(found.shape):
        M = mass[np.ix_(five.joints, five.joints, [i])][..., 0]
        np.testing.assert_allclose(shape.T @ M @ shape, np.eye(5), atol=1e-9)
        K = shape.T @ np.diag(five.stiffness_n_m_per_rad) @ shape
        omega = 2 * np.pi * found.f_hz[i]
        np.testing.assert_allclose(K / np.outer(omega, omega), np.eye(5), atol=1e-9)


def test_damping_is_exact_where_c_is_proportional_to_k(arm, five, joints_rad):
    """With C = b K every mode has zeta = b omega / 2."""
    b = 1e-4
    proportional = ElasticJoints(
        joints=five.joints,
        stiffness_n_m_per_rad=five.stiffness_n_m_per_rad,
        damping_n_m_s_per_rad=b * five.stiffness_n_m_per_rad,
    )
    found = spectrum(ArmBatch(arm), joints_rad, proportional)
    np.testing.assert_allclose(found.damping_ratio, b * np.pi * found.f_hz, rtol=1e-9)


def test_the_elastic_joints_are_those_of_the_believed_structure(arm):
    elastic, believed = elastic_joints(arm), believed_structure(arm)
    assert elastic.joints == believed.joints
    np.testing.assert_array_equal(elastic.stiffness_n_m_per_rad, believed.stiffness_n_m_per_rad)


def test_an_arm_without_springs_is_refused(arm):
    stiff = replace(arm, joints=tuple(replace(j, stiffness=None) for j in arm.joints))
    with pytest.raises(ArmError, match="at least one joint with a stiffness"):
        elastic_joints(stiff)
