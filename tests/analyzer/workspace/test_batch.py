"""Many postures at once against one posture at a time, by other formulas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from armodal.analyzer.arm.inertia import moments_about_joints
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

EXACT = 1e-12  # of the largest value: rounding of some hundred products


@pytest.fixture(scope="module")
def joints_rad(arm):
    return np.random.default_rng(1).uniform(-3.0, 3.0, size=(20, len(arm.joints)))


def test_mass_matrices_are_those_of_one_posture_at_a_time(arm, joints_rad):
    superset = Superset(arm)
    columns = [superset.joint_column(i) for i in range(len(arm.joints))]
    many = ArmBatch(arm).mass(joints_rad)
    for i, q in enumerate(joints_rad):
        one = superset.posture(q).mass[np.ix_(columns, columns)]
        np.testing.assert_allclose(many[..., i], one, rtol=0, atol=EXACT * one.max())


def test_the_diagonal_is_the_moment_of_inertia_about_each_joint(arm, joints_rad):
    """File 002, Eqs. (8) and (9), with I_j inside the sum."""
    superset = Superset(arm)
    many = ArmBatch(arm).mass(joints_rad)
    for i, q in enumerate(joints_rad):
        moments = moments_about_joints(arm, superset.posture(q).T_base_link)
        np.testing.assert_allclose(np.diag(many[..., i]), moments, rtol=1e-11)


def test_points_are_where_forward_kinematics_puts_them(arm, joints_rad):
    superset, batch = Superset(arm), ArmBatch(arm)
    point = np.array([0.1, -0.2, 0.3])
    for link in range(len(arm.joints)):
        many = batch.position(joints_rad, link, point)
        one = np.array(
            [
                T[:3, :3] @ point + T[:3, 3]
                for T in (superset.posture(q).T_base_link[link] for q in joints_rad)
            ]
        )
        np.testing.assert_allclose(many.T, one, rtol=0, atol=1e-13)  # metres, below 1 m


def test_gravity_torque_is_the_slope_of_the_potential_energy(arm, joints_rad):
    batch = ArmBatch(arm)

    def energy(q):
        total = 0.0
        for link, joint in enumerate(arm.joints):
            center = batch.position(q[None], link, joint.link.center_m)[:, 0]
            total -= joint.link.mass_kg * arm.gravity_m_s2 @ center
        return total

    torque = batch.gravity_torque(joints_rad[:4])
    step = 1e-5
    for column, q in enumerate(joints_rad[:4]):
        for joint in range(len(q)):
            move = step * np.eye(len(q))[joint]
            slope = (energy(q + move) - energy(q - move)) / (2 * step)
            # A central difference of 100 J of energy keeps about 1e-14 * 100 / step = 1e-7 N m.
            assert slope == pytest.approx(torque[joint, column], abs=1e-6)


def test_any_direction_of_a_joint_axis_is_fine():
    """Axes that are no coordinate axes, against pinocchio."""
    arm = load_arm("rv4frl")
    rng = np.random.default_rng(2)
    joints = []
    for joint in arm.joints:
        axis = rng.normal(size=3)
        joints.append(replace(joint, axis=axis / np.linalg.norm(axis)))
    odd = replace(arm, joints=tuple(joints))
    model = pin.Model()
    parent = 0
    for joint in odd.joints:
        T = joint.T_parent_joint
        parent = model.addJoint(
            parent,
            pin.JointModelRevoluteUnaligned(joint.axis),
            pin.SE3(T[:3, :3], T[:3, 3]),
            joint.name,
        )
        inertia = pin.Inertia(joint.link.mass_kg, joint.link.center_m, joint.link.inertia_kg_m2)
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    data = model.createData()
    q = rng.uniform(-3, 3, size=(5, len(joints)))
    many = ArmBatch(odd).mass(q)
    for i in range(5):
        one = np.triu(pin.crba(model, data, q[i]))
        np.testing.assert_allclose(np.triu(many[..., i]), one, rtol=0, atol=EXACT * one.max())


def test_a_wrong_number_of_angles_is_said(arm):
    with pytest.raises(ArmError, match=r"wanted joint angles of shape \(postures, 6\)"):
        ArmBatch(arm).mass(np.zeros((3, 5)))
