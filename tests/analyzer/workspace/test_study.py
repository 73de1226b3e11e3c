from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.coupling import sweep_coupling
from armodal.analyzer.workspace.maps import map_frequencies
from armodal.analyzer.workspace.meridian import ELBOWS, meridian_plane
from armodal.analyzer.workspace.moments import moments_of
from armodal.analyzer.workspace.postures import CHUNK, random_postures
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.analyzer.workspace.study import study_workspace
from armodal.protocols.errors import ArmError


@given(st.lists(st.integers(1, 50), min_size=1, max_size=6), st.integers(0, 2**32 - 1))
def test_moments_of_parts_joined_are_those_of_the_whole(sizes, seed):
    rng = np.random.default_rng(seed)
    parts = [rng.normal(3.0, 2.0, size=(n, 2)) for n in sizes]
    joined = moments_of(parts[0], 0)
    for part in parts[1:]:
        joined = joined.joined(moments_of(part, 0))
    whole = np.concatenate(parts)
    assert joined.count == len(whole)
    np.testing.assert_allclose(joined.mean, whole.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(joined.std, whole.std(axis=0), rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(joined.lowest, whole.min(axis=0))
    np.testing.assert_array_equal(joined.highest, whole.max(axis=0))


def test_an_executor_gives_the_same_numbers_to_the_last_bit(arm):
    n = 2 * CHUNK + 17
    here = study_workspace(arm, elastic_joints(arm), n, seed=5)
    with ThreadPoolExecutor(2) as executor:
        there = study_workspace(arm, elastic_joints(arm), n, seed=5, executor=executor)
    np.testing.assert_array_equal(here.f_hz.mean, there.f_hz.mean)
    np.testing.assert_array_equal(here.mass.std, there.mass.std)
    assert here.f_hz.count == n


def test_progress_ends_at_the_number_wanted(arm):
    seen = []
    study_workspace(
        arm, elastic_joints(arm), CHUNK + 1, progress=lambda done, of: seen.append((done, of))
    )
    assert seen == [(CHUNK, CHUNK + 1), (CHUNK + 1, CHUNK + 1)]


def test_joint_1_does_not_change_the_spectrum_of_an_arm_on_a_level_floor(arm):
    """The mass matrix does not know joint 1's angle: file 002, section 6, sets it to zero."""
    rng = np.random.default_rng(6)
    q = random_postures(arm, 50, rng)
    still = q.copy()
    still[:, 0] = 0.0
    batch = ArmBatch(arm)
    np.testing.assert_allclose(batch.mass(q), batch.mass(still), rtol=0, atol=1e-13)


def test_random_postures_fill_the_joint_ranges_and_nothing_else(arm):
    q = random_postures(arm, 4000, np.random.default_rng(7), still=(0,))
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    assert (q[:, 0] == 0.0).all()
    assert (q[:, 1:] >= low[1:]).all()
    assert (q[:, 1:] <= high[1:]).all()
    # The mean of 4000 uniform draws strays by 5 standard deviations once in two million.
    spread = (high - low)[1:] / np.sqrt(12 * 4000)
    assert (np.abs(q[:, 1:].mean(axis=0) - (low + high)[1:] / 2) < 5 * spread).all()


def test_the_wrist_stands_where_the_map_says(arm):
    plane, batch = meridian_plane(arm), ArmBatch(arm)
    found = map_frequencies(arm, elastic_joints(arm), n_lines=41)
    grid = np.meshgrid(found.horizontal_m, found.vertical_m)
    for elbow in range(len(ELBOWS)):
        reached = np.isfinite(found.f_hz[elbow, ..., 0])
        at = batch.position(found.joints_rad[elbow][reached], 4, np.zeros(3))
        np.testing.assert_allclose(plane.horizontal @ at, grid[0][reached], atol=1e-12)
        np.testing.assert_allclose(plane.vertical @ at, grid[1][reached], atol=1e-12)


def test_elbow_up_is_above_the_line_from_shoulder_to_wrist_in_front(arm):
    plane, batch = meridian_plane(arm), ArmBatch(arm)
    horizontal, vertical = np.meshgrid(np.linspace(0.1, 0.6, 20), np.linspace(0.1, 0.8, 20))
    q = plane.joints(horizontal, vertical, "up")
    reached = np.isfinite(q[..., 1])
    assert reached.any()
    elbow = batch.position(q[reached], 2, np.zeros(3))
    toward = horizontal[reached] + 1j * vertical[reached] - plane.shoulder_m
    at = plane.horizontal @ elbow + 1j * (plane.vertical @ elbow) - plane.shoulder_m
    assert (np.imag(np.conj(toward) * at) > 0).all()


def test_a_place_out_of_reach_is_said_with_the_reach(arm):
    plane = meridian_plane(arm)
    with pytest.raises(ArmError, match=r"does not reach \(2.000, 0.000\) m"):
        plane.joints_at(2.0, 0.0, "up")


def test_an_arm_without_parallel_joints_has_no_meridian_plane(arm):
    joints = list(arm.joints)
    joints[2] = replace(joints[2], axis=np.array([1.0, 0.0, 0.0]))
    with pytest.raises(ArmError, match="joint_2 of arm 'rv4frl' and none of joint_3 are parallel"):
        meridian_plane(replace(arm, joints=tuple(joints)))


def test_coupling_is_zero_where_the_sweep_says(arm):
    found = sweep_coupling(arm, (1, 2), joint=2, limits_rad=(-np.pi, np.pi))
    assert len(found.zeros_rad) == 2
    q = np.zeros((2, len(arm.joints)))
    q[:, 2] = found.zeros_rad
    mass = ArmBatch(arm).mass(q)
    assert np.abs(mass[1, 2] / mass[2, 2]).max() < 1e-12


@pytest.mark.parametrize("n", [0, -3])
def test_a_study_of_no_posture_is_refused(arm, n):
    with pytest.raises(ArmError, match="at least one posture"):
        study_workspace(arm, elastic_joints(arm), n)
