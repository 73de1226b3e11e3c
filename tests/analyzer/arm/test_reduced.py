"""Reduction of the superset to a structure, and the modes of what is left."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import any_of, with_effects
from support.plain_arm import TESTS_DEG, mass_matrix

from armodal.analyzer.arm import Axis, Structure, Superset, reduce_model
from armodal.analyzer.arm.reduced import model_modes, selection
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.corrected.held import held_arm
from armodal.protocols.errors import EstimateError

Q = np.deg2rad(TESTS_DEG[0])


def hidden_axis(k=9e4):
    direction = np.array([1.0, 0.0, 0.29]) / np.hypot(1.0, 0.29)
    point = np.array([0.0, 0.0182, 0.1955])
    return Axis(
        link=0,
        direction=direction,
        point_m=point - direction * (direction @ point),
        stiffness_n_m_per_rad=k,
        damping_n_m_s_per_rad=8.0,
    )


def test_locking_a_joint_deletes_its_row_and_column(arm, superset):
    structure = Structure(
        joints=(0, 2),
        stiffness_n_m_per_rad=np.array([2e4, 1e4]),
        damping_n_m_s_per_rad=np.array([15.0, 6.0]),
    )
    model = reduce_model(superset, superset.posture(Q), structure)
    whole = mass_matrix(arm, Q)
    np.testing.assert_allclose(model.mass, whole[np.ix_([0, 2], [0, 2])], rtol=1e-11, atol=1e-13)
    np.testing.assert_array_equal(model.damping, np.diag([15.0, 6.0]))


def test_selection_puts_an_axis_on_the_six_columns_of_its_link(superset):
    structure = replace(believed_structure(superset.arm), axes=(hidden_axis(),))
    T = selection(superset, structure)
    assert T.shape == (superset.n, 4)
    np.testing.assert_array_equal(T[superset.interface_columns(0), 3], hidden_axis().twist())
    assert np.count_nonzero(T[:, :3]) == 3


def test_a_sensor_on_a_point_weighs_like_a_body_there(arm, superset):
    structure = replace(believed_structure(arm), axes=(hidden_axis(),))
    number, mass = superset.point_index["7"], 0.05
    added = np.zeros(len(arm.points))
    added[number] = mass
    found = reduce_model(superset, superset.posture(Q), structure, added_mass_kg=added)

    # The link with a point mass: total mass, common centre, Huygens-Steiner.
    joint = superset.point_link[number]
    link, at = arm.joints[joint].link, arm.points[number].position_m
    center = (link.mass_kg * link.center_m + mass * at) / (link.mass_kg + mass)
    inertia = link.inertia_kg_m2.copy()
    for m, r in ((link.mass_kg, link.center_m - center), (mass, at - center)):
        inertia = inertia + m * (r @ r * np.eye(3) - np.outer(r, r))
    heavier = replace(link, mass_kg=link.mass_kg + mass, center_m=center, inertia_kg_m2=inertia)
    joints = list(arm.joints)
    joints[joint] = replace(joints[joint], link=heavier)
    other = Superset(replace(arm, joints=tuple(joints)))
    wanted = reduce_model(other, other.posture(Q), structure)
    np.testing.assert_allclose(found.mass, wanted.mass, rtol=1e-11, atol=1e-13)


def test_a_very_stiff_axis_leaves_the_joints_modes_as_they_were(arm, superset):
    bare = believed_structure(arm)
    dynamics = superset.posture(Q)
    stiff = model_modes(
        reduce_model(superset, dynamics, replace(bare, axes=(hidden_axis(k=1e11),)))
    )
    without = model_modes(reduce_model(superset, dynamics, bare))
    # The axis gives way by k_joint / k_axis, 1e-7.
    np.testing.assert_allclose(stiff.f_hz[:3], without.f_hz, rtol=1e-6)


def test_modes_solve_the_quadratic_eigenvalue_problem(arm, superset):
    structure = replace(believed_structure(arm), axes=(hidden_axis(),))
    model = reduce_model(superset, superset.posture(Q), structure)
    modes = model_modes(model)
    assert (np.diff(modes.f_hz) > 0).all()
    for pole, shape in zip(modes.pole_rad_s, modes.shape.T, strict=True):
        terms = [
            pole**2 * model.mass @ shape,
            pole * model.damping @ shape,
            model.stiffness @ shape,
        ]
        size = max(np.linalg.norm(term) for term in terms)
        np.testing.assert_allclose(sum(terms), 0.0, atol=1e-10 * size)


def test_what_is_damped_above_critical_is_named(arm):
    """A bearing of an arm file that stays as it is, its loss 0.2 s; and a spring below zero."""
    ready = held_arm(with_effects(arm, any_of(arm, "bearing")))
    bare = believed_structure(ready.arm)
    held = ready.held
    creeping = replace(held, damping=held.damping + 0.2 * np.diag([0, 0, 0, 1, 0]) * held.stiffness)
    superset = Superset(ready.arm)
    structure = replace(bare, held=creeping)
    with pytest.raises(EstimateError, match=r"damped above critical: bearing a joint_1 \(\d"):
        model_modes(reduce_model(superset, superset.posture(Q), structure))
    loose = replace(bare, stiffness_n_m_per_rad=bare.stiffness_n_m_per_rad * [1, -1, 1])
    with pytest.raises(EstimateError, match="nothing holds joint_2: check"):
        model_modes(reduce_model(superset, superset.posture(Q), loose))
