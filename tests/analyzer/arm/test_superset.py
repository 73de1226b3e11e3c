"""The superset model against formulas written out here from the arm's description alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from armodal.analyzer.arm.inertia import moments_about_joints
from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.structure import Axis, Structure, believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError, EstimateError

# File 000, Table 2, degrees: the posture chosen for each of joints 1 to 3.
TESTS_DEG = [[-25, 90, 0, 0, 90, 0], [-25, 0, 98, 0, -9, 0], [-25, -80, 155, 2, -75, 0]]


@pytest.fixture(scope="module")
def arm():
    return load_arm("rv4frl")


@pytest.fixture(scope="module")
def superset(arm):
    return Superset(arm)


def links_at(arm, joints_rad):
    """Pose of every link in base, product of the joints' transforms."""
    T, poses = np.eye(4), []
    for joint, angle in zip(arm.joints, joints_rad, strict=True):
        turn = np.eye(4)
        turn[:3, :3] = Rotation.from_rotvec(angle * joint.axis).as_matrix()
        T = T @ joint.T_parent_joint @ turn
        poses.append(T)
    return poses


def postures(n):
    return np.random.default_rng(5).uniform(-2.5, 2.5, size=(n, 6))


def joint_columns(superset):
    return [superset.joint_column(i) for i in range(superset.n_joints)]


def test_links_stand_where_forward_kinematics_puts_them(arm, superset):
    for q in postures(5):
        np.testing.assert_allclose(superset.posture(q).T_base_link, links_at(arm, q), atol=1e-13)


def test_the_mass_matrix_is_the_sum_over_links_of_their_kinetic_energy(arm, superset):
    """File 002, Eqs. (4) and (5), with Jacobians by central differences of the link poses."""
    step = 1e-6
    columns = joint_columns(superset)
    for q in postures(3):
        M = np.zeros((6, 6))
        here = links_at(arm, q)
        ahead = [links_at(arm, q + step * unit) for unit in np.eye(6)]
        behind = [links_at(arm, q - step * unit) for unit in np.eye(6)]
        for i, joint in enumerate(arm.joints):
            link, R = joint.link, here[i][:3, :3]
            center = np.append(link.center_m, 1.0)
            Jp = np.stack(
                [(a[i] @ center - b[i] @ center)[:3] for a, b in zip(ahead, behind, strict=True)],
                axis=1,
            ) / (2 * step)
            turns = [
                (a[i][:3, :3] - b[i][:3, :3]) @ R.T / (2 * step)
                for a, b in zip(ahead, behind, strict=True)
            ]
            Jo = np.stack([[W[2, 1], W[0, 2], W[1, 0]] for W in turns], axis=1)
            inertia = R @ link.inertia_kg_m2 @ R.T
            M += link.mass_kg * Jp.T @ Jp + Jo.T @ inertia @ Jo
        found = superset.posture(q).mass[np.ix_(columns, columns)]
        # Central differences of 1e-6 are good to about 1e-9 of a Jacobian.
        np.testing.assert_allclose(found, M, atol=1e-8)


def test_the_diagonal_is_the_moment_of_inertia_about_each_joint(arm, superset):
    """File 002, Eqs. (8) and (9), with I_j inside the sum."""
    columns = joint_columns(superset)
    for q in postures(5):
        dynamics = superset.posture(q)
        moments = moments_about_joints(arm, dynamics.T_base_link)
        np.testing.assert_allclose(np.diag(dynamics.mass)[columns], moments, rtol=1e-11)


def test_with_the_printed_inertia_inside_the_sum_it_would_not_be(arm, superset):
    """The erratum of file 002, Eq. (8): I_i instead of I_j is another number."""
    wrong = replace(
        arm,
        joints=tuple(
            replace(joint, link=replace(joint.link, inertia_kg_m2=arm.joints[0].link.inertia_kg_m2))
            for joint in arm.joints
        ),
    )
    dynamics = superset.posture(postures(1)[0])
    right = dynamics.mass[0, 0]
    printed = moments_about_joints(wrong, dynamics.T_base_link)[0]
    assert abs(printed / right - 1) > 0.01  # the right sum agrees to 1e-11


def test_the_inertias_behind_file_000_come_out_within_two_per_cent(superset):
    """k / (2 pi f)² of Tables 3 and 4: 2.404, 1.670, 0.357 kg m²."""
    published = (
        np.array([20789.0, 24307.0, 21243.0]) / (2 * np.pi * np.array([14.8, 19.2, 38.8])) ** 2
    )
    for i, posture in enumerate(np.deg2rad(TESTS_DEG)):
        column = superset.joint_column(i)
        found = superset.posture(posture).mass[column, column]
        assert found == pytest.approx(published[i], rel=0.02)


def test_gravity_stiffness_is_the_curvature_of_the_potential_energy(arm, superset):
    columns = joint_columns(superset)

    def energy(q):
        return -sum(
            joint.link.mass_kg * arm.gravity_m_s2 @ (T @ np.append(joint.link.center_m, 1.0))[:3]
            for joint, T in zip(arm.joints, links_at(arm, q), strict=True)
        )

    step = 1e-3
    for q in postures(2):
        found = superset.posture(q).gravity_stiffness[np.ix_(columns, columns)]
        for i, a in enumerate(step * np.eye(6)):
            for j, b in enumerate(step * np.eye(6)):
                corners = energy(q + a + b) - energy(q + a - b) - energy(q - a + b)
                curvature = (corners + energy(q - a - b)) / (4 * step**2)
                # Second differences: step² of the fourth derivative, 1e-6 of 100 N m.
                assert curvature == pytest.approx(found[i, j], abs=3e-4)


def test_point_jacobians_are_the_motion_of_the_points(arm, superset):
    step = 1e-6
    columns = joint_columns(superset)
    q = postures(1)[0]
    dynamics = superset.posture(q)
    for column, unit in zip(columns, np.eye(6), strict=True):
        moved = (
            superset.posture(q + step * unit).point_position
            - superset.posture(q - step * unit).point_position
        ) / (2 * step)
        np.testing.assert_allclose(moved, dynamics.point_jacobian[:, :3, column], atol=1e-9)


def test_postures_evaluated_together_are_those_evaluated_alone(arm):
    angles = [np.full(len(arm.joints), 0.1 * i) for i in (1, 2, 1)]
    together = Superset(arm).postures(angles)
    for found, each in zip(together, angles, strict=True):
        alone = Superset(arm).posture(each)
        np.testing.assert_array_equal(found.mass, alone.mass)
        np.testing.assert_array_equal(found.gravity_stiffness, alone.gravity_stiffness)
        np.testing.assert_array_equal(found.point_jacobian, alone.point_jacobian)


def test_points_of_the_base_move_with_the_base_alone(superset):
    dynamics = superset.posture(postures(1)[0])
    fixed = [i for i, link in enumerate(superset.point_link) if link < 0]
    assert fixed
    base = slice(0, 6)  # the interface between floor and base comes first
    assert not dynamics.point_jacobian[fixed][..., base.stop :].any()
    position = dynamics.point_position[fixed[0]]
    turned = dynamics.point_jacobian[fixed[0], :3, base][:, 3:]
    np.testing.assert_allclose(turned.T, np.cross(np.eye(3), position), atol=1e-15)


def test_mass_matrix_is_the_sum_of_the_links_kinetic_energies(arm, superset):
    dynamics = superset.posture(postures(1)[0])
    M = np.zeros((superset.n, superset.n))
    for joint, J in zip(arm.joints, dynamics.link_jacobian, strict=True):
        link = joint.link
        at_center = J[:3] + np.cross(J[3:].T, link.center_m).T
        M += link.mass_kg * at_center.T @ at_center + J[3:].T @ link.inertia_kg_m2 @ J[3:]
    np.testing.assert_allclose(dynamics.mass, M, atol=1e-12)


def test_gravity_stiffness_is_the_sum_over_masses_and_first_moments(arm, superset):
    q = postures(1)[0]
    per_mass = superset.gravity_stiffness_per_mass(q)
    moments = np.array(
        [[1.0, *joint.link.center_m] * np.array(joint.link.mass_kg) for joint in arm.joints]
    )
    K = np.einsum("la,laij->ij", moments, per_mass)
    np.testing.assert_allclose(K, superset.posture(q).gravity_stiffness, atol=1e-9)


def test_a_released_axis_moves_points_as_a_rotation_about_its_line(arm, superset):
    """Column of an axis at link 1's root against turning everything beyond it by a small angle."""
    direction = np.array([0.96, 0.0, 0.28])
    point = np.array([-0.05, 0.02, 0.18])
    point = point - direction * (direction @ point)
    axis = Axis(
        link=0,
        direction=direction,
        point_m=point,
        stiffness_n_m_per_rad=1.0,
        damping_n_m_s_per_rad=1.0,
    )
    structure = Structure(
        joints=(),
        stiffness_n_m_per_rad=np.zeros(0),
        damping_n_m_s_per_rad=np.zeros(0),
        axes=(axis,),
    )
    q = postures(1)[0]
    dynamics = superset.posture(q)
    model = reduce_model(superset, dynamics, structure)
    T = dynamics.T_base_link[0]
    u, p = T[:3, :3] @ direction, T[:3, :3] @ point + T[:3, 3]
    small = 1e-6
    turn = Rotation.from_rotvec(small * u).as_matrix()
    for i, link in enumerate(superset.point_link):
        x = dynamics.point_position[i]
        moved = (turn @ (x - p) + p - x) / small if link >= 0 else np.zeros(3)
        # First order in the angle: 1e-6 of a metre.
        np.testing.assert_allclose(model.point_jacobian[i, :3, 0], moved, atol=2e-6)


def test_an_axis_along_a_joint_has_the_joint_s_moment_of_inertia(arm, superset):
    axis = Axis(
        link=0,
        direction=np.array([0.0, 0.0, 1.0]),
        point_m=np.zeros(3),
        stiffness_n_m_per_rad=1.0,
        damping_n_m_s_per_rad=1.0,
    )
    structure = Structure(
        joints=(0,),
        stiffness_n_m_per_rad=np.ones(1),
        damping_n_m_s_per_rad=np.ones(1),
        axes=(axis,),
    )
    model = reduce_model(superset, superset.posture(postures(1)[0]), structure)
    assert model.mass[1, 1] == pytest.approx(model.mass[0, 0], rel=1e-12)
    assert model.mass[0, 1] == pytest.approx(model.mass[0, 0], rel=1e-12)


def test_an_added_mass_is_a_point_mass(arm, superset):
    structure = believed_structure(arm)
    dynamics = superset.posture(postures(1)[0])
    masses = np.zeros(len(arm.points))
    masses[superset.point_index["1"]] = 0.5
    with_mass = reduce_model(superset, dynamics, structure, added_mass_kg=masses).mass
    J = dynamics.point_jacobian[superset.point_index["1"], :3][:, joint_columns(superset)[:3]]
    without = reduce_model(superset, dynamics, structure).mass
    np.testing.assert_allclose(with_mass - without, 0.5 * J.T @ J, atol=1e-12)


def test_one_free_joint_oscillates_as_a_single_degree_of_freedom(arm, superset):
    """Closed form: omega² = k/m, zeta = c / (2 sqrt(k m)), gravity's stiffness included."""
    k, c = 2.0e4, 15.0
    structure = Structure(
        joints=(1,), stiffness_n_m_per_rad=np.array([k]), damping_n_m_s_per_rad=np.array([c])
    )
    dynamics = superset.posture(np.deg2rad(TESTS_DEG[1]))
    column = superset.joint_column(1)
    m = dynamics.mass[column, column]
    stiff = k + dynamics.gravity_stiffness[column, column]
    modes = model_modes(reduce_model(superset, dynamics, structure))
    assert modes.f_hz[0] == pytest.approx(np.sqrt(stiff / m) / (2 * np.pi), rel=1e-12)
    assert modes.damping_ratio[0] == pytest.approx(c / (2 * np.sqrt(stiff * m)), rel=1e-9)


def test_gravity_lowers_joint_2_as_computed_from_the_paper(superset):
    """About -42 N m/rad in test 2 of file 000, 0.17 % of k."""
    column = superset.joint_column(1)
    found = superset.posture(np.deg2rad(TESTS_DEG[1])).gravity_stiffness[column, column]
    assert found == pytest.approx(-42, abs=1.0)  # given to two digits


def test_a_mode_that_does_not_oscillate_is_said(arm, superset):
    structure = Structure(
        joints=(0,), stiffness_n_m_per_rad=np.array([1.0]), damping_n_m_s_per_rad=np.array([1e4])
    )
    with pytest.raises(EstimateError, match="oscillating modes"):
        model_modes(reduce_model(superset, superset.posture(np.zeros(6)), structure))


@pytest.mark.parametrize("angles", [[0.0] * 5, [0.0, 0.0, np.nan, 0.0, 0.0, 0.0]])
def test_angles_that_are_no_posture_are_refused(superset, angles):
    with pytest.raises(ArmError, match="6 finite joint angles"):
        superset.posture(angles)
