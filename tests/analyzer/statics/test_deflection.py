"""File 001, section 4: what its figures say of loads on a tool, as computed statements.

The paper prints neither the postures nor the forces of its scenarios, so the postures here are our
own: an arm whose meridian plane holds the tool, joints 1 to 3 elastic.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.screws import MozziAxis, Translation
from armodal.analyzer.statics.deflection import deflect, joint_lines
from armodal.analyzer.statics.ranking import rank_postures
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints, elastic_joints
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

IN_PLANE = np.deg2rad([[0.0, 20.0, 80.0, 0.0, 60.0, 0.0]])  # the tool in the meridian plane
FORCE_N = 100.0
angles = st.floats(-2.5, 2.5)


@pytest.fixture(scope="module")
def batch():
    return ArmBatch(load_arm("rv4frl"))


@pytest.fixture(scope="module")
def elastic(batch):
    return elastic_joints(batch.arm)


def loaded(batch, elastic, force, *, tool_m=(0.0, 0.0, 0.0), joints_rad=IN_PLANE):
    wrench = np.concatenate([np.asarray(force, float), np.zeros(3)])
    return deflect(batch, elastic, joints_rad, wrench, tool_m=tool_m)


@pytest.mark.parametrize("force", [(FORCE_N, 0, 0), (0, 0, FORCE_N), (60.0, 0, -80.0)])
def test_a_force_in_the_meridian_plane_turns_the_tool_about_an_axis_along_joints_2_and_3(
    batch, elastic, force
):
    """Figs. 15 to 17: same direction as joints 2 and 3, no slide."""
    axis = loaded(batch, elastic, force).mozzi()
    assert isinstance(axis, MozziAxis)
    lines = joint_lines(batch, IN_PLANE[0], axis)
    assert lines[1].angle_deg == pytest.approx(0.0, abs=1e-9)
    assert lines[2].angle_deg == pytest.approx(0.0, abs=1e-9)
    assert axis.pitch_m_per_rad == pytest.approx(0.0, abs=1e-12)


def test_a_force_that_passes_joint_2_turns_the_tool_about_joint_3(batch, elastic):
    """Fig. 15: a small lever arm about joint 2 leaves the motion to joint 3."""
    origin, _ = batch.joint_axes(IN_PLANE)
    tool = batch.position(IN_PLANE, 5, np.zeros(3))[:, 0]
    toward = tool - origin[1, :, 0]
    axis = loaded(batch, elastic, FORCE_N * toward / np.linalg.norm(toward)).mozzi()
    assert isinstance(axis, MozziAxis)
    assert joint_lines(batch, IN_PLANE[0], axis)[2].distance_m == pytest.approx(0.0, abs=1e-9)


def test_a_vertical_force_puts_the_axis_between_joints_2_and_3(batch, elastic):
    """Figs. 16 and 17: both comply, and the axis crosses the arm between them."""
    found = loaded(batch, elastic, (0, 0, FORCE_N))
    share = found.joint_rotation_rad[0]
    assert share[1] * share[2] > 0
    axis = found.mozzi()
    assert isinstance(axis, MozziAxis)
    origin, _ = batch.joint_axes(IN_PLANE)
    apart = origin[2, :, 0] - origin[1, :, 0]
    along = (axis.point_m - origin[1, :, 0]) @ apart / (apart @ apart)
    # Parallel rotations about two axes are one about the point that divides them by their sizes.
    assert along == pytest.approx(share[2] / (share[1] + share[2]), rel=1e-9)
    assert 0.0 < along < 1.0


def test_a_lateral_force_turns_the_tool_about_joint_1(batch, elastic):
    """Figs. 18 and 19: the axis coincides with joint 1's."""
    found = loaded(batch, elastic, (0, FORCE_N, 0))
    axis = found.mozzi()
    assert isinstance(axis, MozziAxis)
    line = joint_lines(batch, IN_PLANE[0], axis)[0]
    assert (line.angle_deg, line.distance_m) == pytest.approx((0.0, 0.0), abs=1e-9)
    np.testing.assert_allclose(found.joint_share[0], [1.0, 0.0, 0.0], atol=1e-12)


def test_an_eccentric_force_gives_an_oblique_axis_with_a_slide(batch, elastic):
    """Fig. 20: all joints comply, the axis is tilted, and the tool slides along it."""
    found = loaded(batch, elastic, (FORCE_N, 0, 0), tool_m=(0.0, 0.15, 0.05))
    axis = found.mozzi()
    assert isinstance(axis, MozziAxis)
    assert (np.abs(found.joint_rotation_rad[0]) > 1e-6).all()
    for line in joint_lines(batch, IN_PLANE[0], axis)[:3]:
        assert line.angle_deg > 1.0
    assert abs(axis.pitch_m_per_rad) > 1e-3


def test_a_small_lateral_part_of_a_milling_force_makes_joint_1_comply(batch, elastic):
    """Fig. 14: a force in a plane parallel to y-z, a long lever arm about joint 1."""
    stretched = np.deg2rad([[0.0, 45.0, 60.0, 0.0, 75.0, 0.0]])
    found = loaded(batch, elastic, (0, 0.2 * FORCE_N, -FORCE_N), joints_rad=stretched)
    rotation = np.abs(found.joint_rotation_rad[0])
    # A fifth of the force, but a joint that gives: its rotation is no fifth of the others'.
    assert rotation[0] > 0.05 * rotation[1:].max()


@given(st.lists(angles, min_size=6, max_size=6), st.lists(angles, min_size=3, max_size=3))
def test_the_tool_moves_into_the_half_space_of_the_force(q, force):
    """File 001, end of section 4: dO_t lies within the semispace of F."""
    batch = ArmBatch(load_arm("rv4frl"))
    found = loaded(batch, elastic_joints(batch.arm), force, joints_rad=[q])
    work = float(np.dot(found.displacement_m[0], force))
    # Twice the energy in the springs, so never negative; rounding of products below 1e-4.
    assert work >= -1e-18


def test_displacement_is_the_compliance_times_the_wrench_and_the_work_is_in_the_springs(
    batch, elastic
):
    wrench = np.array([30.0, -20.0, 50.0, 2.0, -1.0, 3.0])
    q = np.random.default_rng(1).uniform(-2, 2, size=(5, 6))
    tool = (0.02, 0.03, 0.1)
    found = deflect(batch, elastic, q, wrench, tool_m=tool)
    motion = np.concatenate([found.displacement_m, found.rotation_rad], axis=1)
    each = [deflect(batch, elastic, q, unit, tool_m=tool) for unit in np.eye(6)]
    compliance = np.stack(
        [np.concatenate([u.displacement_m, u.rotation_rad], axis=1) for u in each], axis=2
    )
    np.testing.assert_allclose(compliance @ wrench, motion, rtol=1e-12)
    np.testing.assert_allclose(compliance, np.swapaxes(compliance, 1, 2), atol=1e-18)
    stored = (elastic.stiffness_n_m_per_rad * found.joint_rotation_rad**2).sum(axis=1)
    np.testing.assert_allclose(motion @ wrench, stored, rtol=1e-12)
    np.testing.assert_allclose(found.joint_share.sum(axis=1), 1.0, rtol=1e-12)


def test_small_joint_rotations_move_the_tool_as_forward_kinematics_says(batch, elastic):
    q = np.random.default_rng(2).uniform(-2, 2, size=(4, 6))
    found = deflect(batch, elastic, q, [1e-2, 2e-2, -1e-2, 0, 0, 0], tool_m=(0, 0.1, 0.2))
    turned = q.copy()
    turned[:, list(elastic.joints)] += found.joint_rotation_rad
    moved = batch.position(turned, 5, (0, 0.1, 0.2)) - batch.position(q, 5, (0, 0.1, 0.2))
    # 1e-6 rad: the second order is 1e-12 m, and so is the rounding of a difference of metres / 1e4.
    np.testing.assert_allclose(moved.T, found.displacement_m, atol=1e-11)


def test_no_load_moves_nothing_and_has_no_axis(batch, elastic):
    found = deflect(batch, elastic, IN_PLANE, np.zeros(6))
    assert found.mozzi() is None
    assert np.isnan(found.joint_share).all()


def test_opposite_equal_rotations_of_parallel_joints_are_a_translation(batch):
    """A load that turns joints 2 and 3 by opposite amounts shifts the tool without turning it."""
    pair = ElasticJoints(
        joints=(1, 2),
        stiffness_n_m_per_rad=np.array([2e4, 2e4]),
        damping_n_m_s_per_rad=np.zeros(2),
    )
    # A force along the line from which both axes are equally far, on opposite sides.
    origin, _ = batch.joint_axes(IN_PLANE)
    tool = batch.position(IN_PLANE, 5, np.zeros(3))[:, 0]
    middle = (origin[1, :, 0] + origin[2, :, 0]) / 2
    force = FORCE_N * (middle - tool) / np.linalg.norm(middle - tool)
    found = deflect(batch, pair, IN_PLANE, np.concatenate([force, np.zeros(3)]))
    assert np.linalg.norm(found.rotation_rad) < 1e-9 * np.linalg.norm(found.displacement_m)
    assert isinstance(found.mozzi(), Translation)


def test_ranking_orders_postures_and_measures_the_axis_as_the_single_posture_does(batch, elastic):
    q = np.random.default_rng(3).uniform(-2, 2, size=(200, 6))
    wrench = [20.0, 5.0, -80.0, 0, 0, 0]
    ranked = rank_postures(batch, elastic, q, wrench, (0, 0, 1))
    assert (np.diff(ranked.displacement_m) >= 0).all()
    for i in (0, 57, 199):
        found = deflect(batch, elastic, ranked.joints_rad[[i]], wrench)
        axis = found.mozzi()
        assert isinstance(axis, MozziAxis)
        away = np.cross(ranked.tool_m[i] - axis.point_m, axis.direction)
        # A slide along the axis adds nothing to the distance: only what is across counts.
        assert np.linalg.norm(away) == pytest.approx(ranked.axis_distance_m[i], rel=1e-9)
        assert ranked.into_surface_m[i] == pytest.approx(-found.displacement_m[0, 2], rel=1e-12)


@pytest.mark.parametrize("wrench", [[1, 2, 3], [1, 2, 3, 4, 5, np.nan]])
def test_a_wrench_that_is_none_is_said(batch, elastic, wrench):
    with pytest.raises(ArmError, match="six finite numbers"):
        deflect(batch, elastic, IN_PLANE, wrench)
