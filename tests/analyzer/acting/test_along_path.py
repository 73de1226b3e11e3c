"""The free motion chosen for a whole path, against every chain there is and against its limits."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from support.chain_arm import chain_arm

from armodal.analyzer.acting.along_path import best_along_path
from armodal.analyzer.acting.self_motion import STEP_RAD, stiffest_angle
from armodal.analyzer.corrected.batch import batched


@pytest.mark.parametrize("seed", range(8))
def test_no_chain_within_the_limits_has_a_lower_sum_of_compliances(seed):
    rng = np.random.default_rng(seed)
    p, m, n, step = 4, 5, 3, 0.3
    steps = rng.normal(size=(p, m, n))
    steps *= step / np.linalg.norm(steps, axis=2, keepdims=True)
    joints = np.cumsum(steps, axis=1) + rng.normal(0.0, 0.05, (p, 1, n))
    joints -= joints[:, 2:3] - rng.normal(0.0, 0.05, (p, 1, n))  # the given are near one another
    joints[2, 4] = np.nan
    along = rng.uniform(1.0, 9.0, (p, m))
    along[2, 4] = np.nan
    limit = np.full(p - 1, 0.5)
    chosen = best_along_path(joints, along, step * np.arange(-2, 3), step, limit)
    sums = {}
    for chain in itertools.product(range(m), repeat=p):
        q = joints[range(p), chain]
        if np.isfinite(q).all() and (np.abs(np.diff(q, axis=0)) <= 0.5).all():
            sums[chain] = float((1.0 / along[range(p), chain]).sum())
    assert tuple(chosen) in sums
    # The way from the given posture weighs a millionth of a compliance.
    assert sums[tuple(chosen)] <= min(sums.values()) * (1.0 + 1e-5)


@pytest.mark.long
def test_along_a_path_no_joint_turns_faster_than_the_path_s_own_and_the_tool_gives_way_less():
    ready = batched(chain_arm(7))
    ends = np.array([[0.3, -0.8, -0.2, 1.1, 0.4, 0.8, 0.1], [-0.5, -0.6, 0.3, 0.9, -0.3, 0.6, 0.0]])
    part = np.linspace(0.0, 1.0, 12)[:, None]
    path = (1.0 - part) * ends[0] + part * ends[1]
    free = stiffest_angle(ready, path, (30.0, 40.0, -120.0), tool_m=(0.0, 0.02, 0.1))
    given = np.abs(np.diff(path, axis=0)).max(axis=1)
    turned = np.abs(np.diff(free.together.joints_rad, axis=0)).max(axis=1)
    assert (turned <= np.maximum(given, 2.0 * STEP_RAD) + 1e-6).all()
    mean = [
        float(np.mean(1.0 / own.along_n_per_m)) for own in (free.best, free.together, free.given)
    ]
    assert mean[0] <= mean[1] < 0.98 * mean[2]
