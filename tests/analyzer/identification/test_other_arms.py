"""Plan, measure in simulation and identify: arms other than the demo's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.plan_text import plan_text
from armodal.analyzer.planning.selective import plan_tests
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.arm.files import load_arm

OFF = np.array([1.35, 0.75, 1.25, 0.7, 1.3])  # truth over belief


@pytest.fixture(scope="module")
def believed():
    return load_arm("viper_s650")


@pytest.mark.long
def test_five_joints_of_the_viper_are_identified_from_planned_tests(believed, tmp_path):
    """Springs 25 to 35 % off the belief, the plan made on the belief."""
    elastic = elastic_joints(believed)
    plan = plan_tests(planned_arm(believed), np.random.default_rng(1), n_tests=3)
    path = tmp_path / "plan.toml"
    path.write_text(plan_text(plan, "viper-selective"), encoding="utf-8")
    k = [*(OFF * elastic.stiffness_n_m_per_rad), None]
    c = [*(1.2 * elastic.damping_n_m_s_per_rad), None]
    session = simulate_session(3, plan=path, arm=believed, plant=plant_of_arm(believed, k, c))
    result = identify(session)
    for joint, truth in zip(result.joints, k, strict=False):
        error = joint.k_n_m_per_rad - truth
        # Within two per cent, and within 4 of the stated standard deviations of one session.
        assert abs(error) < 0.02 * truth
        assert abs(error) < 4 * joint.k_std
    assert replace(believed, joints=believed.joints).name == session.header.arm.name
