"""The free motion of redundant arms, and how stiff the tool stands along it."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import axis, with_effects
from support.chain_arm import chain_arm
from support.plain_arm import link_poses

from armodal.analyzer.acting.self_motion import STEP_RAD, self_motion, stiffest_angle
from armodal.analyzer.corrected.batch import batched
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

SEVEN = chain_arm(7)
FORCE, TOOL = (30.0, 40.0, -120.0), (0.0, 0.02, 0.1)
Q = np.array([[0.3, 0.5, -0.2, 1.1, 0.4, 0.8, 0.1], [-0.5, 0.8, 0.3, 0.9, -0.3, 0.6, 0.0]])


def wide(arm, range_rad):
    return replace(arm, joints=tuple(replace(j, range_rad=range_rad) for j in arm.joints))


def tool_pose(arm, q):
    T = link_poses(arm, q)[-1]
    return T[:3, :3], T[:3, :3] @ TOOL + T[:3, 3]


def test_the_tool_of_seven_joints_stays_where_it_is():
    arm = wide(SEVEN, (-2.5, 2.5))
    found = self_motion(batched(arm).batch, Q, tool_m=TOOL)
    there = ~np.isnan(found).any(axis=-1)
    assert (there.sum(axis=1) > 20).all()
    for own, given, its in zip(found, Q, there, strict=True):
        R, p = tool_pose(arm, given)
        for q in own[its][::7]:
            R_there, p_there = tool_pose(arm, q)
            # What the correction is asked for.
            np.testing.assert_allclose(p_there, p, atol=2e-9)
            np.testing.assert_allclose(R_there, R, atol=2e-9)
        assert (np.abs(own[its]) <= 2.5).all()
        steps = np.linalg.norm(np.diff(own[its], axis=0), axis=1)
        # Chords of a curve, brought back across it.
        np.testing.assert_allclose(steps, STEP_RAD, rtol=0.02)


@pytest.mark.long
def test_it_is_the_same_curve_from_any_of_its_postures():
    """Its samples lie elsewhere by a part of a step, so that the best differs by a little."""
    ready = batched(wide(SEVEN, (-2.5, 2.5)))
    first = stiffest_angle(ready, Q[:1], FORCE, tool_m=TOOL)
    along = first.along_n_per_m[0]
    there = np.flatnonzero(np.isfinite(along))
    other = first.joints_rad[0, there[len(there) // 4]]
    second = stiffest_angle(ready, other[None], FORCE, tool_m=TOOL)
    # Half a step beside a maximum, or a whole one from a range's end.
    within = np.nanmax(np.abs(np.diff(along))) / first.best.along_n_per_m[0]
    assert second.best.along_n_per_m == pytest.approx(first.best.along_n_per_m, rel=within)
    assert first.best.along_n_per_m[0] >= first.given.along_n_per_m[0]
    # Solved alone and among others: rounding.
    assert first.best.along_n_per_m[0] == pytest.approx(np.nanmax(along), rel=1e-12)


def test_a_closed_motion_is_followed_once():
    """Of a spherical wrist about its last axis only the last joint turns: one whole round."""
    arm = wide(load_arm("viper_s650"), (-20.0, 20.0))
    q = np.deg2rad([[0, -60, 160, 20, 50, 0]])
    found = self_motion(batched(arm).batch, q, tool_m=(0, 0, 0.1), spin=(0, 0, 1))[0]
    found = found[~np.isnan(found).any(axis=1)]
    np.testing.assert_allclose(found[:, :5], np.repeat(q[:, :5], len(found), 0), atol=1e-9)
    # It ends within a step of the whole round.
    assert 2.0 * np.pi - 2.0 * STEP_RAD < np.ptp(found[:, 5]) < 2.0 * np.pi


@pytest.mark.long
def test_a_tool_across_the_last_axis_gains_by_its_turn_and_one_along_it_does_not():
    viper = load_arm("viper_s650")
    ready = batched(with_effects(viper, axis(viper.joints[1].link.name)))
    q = np.deg2rad([[10, -40, 140, 0, 60, 0]])
    along = stiffest_angle(ready, q, FORCE, tool_m=(0, 0, 0.1), spin=(0, 0, 1))
    np.testing.assert_array_equal(along.best_angle_rad, 0.0)
    across = stiffest_angle(ready, q, FORCE, tool_m=(0.1, 0, 0.1), spin=(1, 0, 0))
    assert (across.best.along_n_per_m > 1.02 * across.given.along_n_per_m).all()
    for given, best in zip(q, across.best.joints_rad, strict=True):
        here, there = (ready.batch.position(a[None], 5, (0.1, 0, 0.1))[:, 0] for a in (given, best))
        np.testing.assert_allclose(there, here, atol=2e-9)
        ends = [ready.batch.position(a[None], 5, (1.1, 0, 0.1))[:, 0] for a in (given, best)]
        np.testing.assert_allclose(ends[1], ends[0], atol=4e-9)


def test_arms_without_exactly_one_free_motion_are_refused():
    ready = batched(load_arm("rv4frl"))
    with pytest.raises(ArmError, match="wanted 7 joints, so that one motion is free"):
        stiffest_angle(ready, np.zeros((1, 6)), FORCE, tool_m=TOOL)
    with pytest.raises(ArmError, match="wanted 6 joints"):
        stiffest_angle(batched(SEVEN), Q, FORCE, tool_m=TOOL, spin=(0, 0, 1))
    with pytest.raises(ArmError, match="take every 2th"):
        self_motion(batched(SEVEN).batch, np.zeros((2001, 7)), tool_m=TOOL)
