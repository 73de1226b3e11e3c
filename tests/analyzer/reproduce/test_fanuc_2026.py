"""Compliance and mass at a drill's tip, against their definitions by force and by energy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from armodal.analyzer.reproduce.fanuc_2026 import (
    TIP_M,
    TRIALS,
    K,
    axial,
    figures_fanuc,
    model_angles,
)
from armodal.analyzer.reproduce.records import Status
from armodal.analyzer.statics.deflection import deflect
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm


@pytest.fixture(scope="module")
def arm():
    return load_arm(ARMS_DIRECTORY.parent / "targets" / "fanuc_r2000ic.toml")


@pytest.mark.parametrize("posture_deg", [posture for posture, _ in TRIALS])
def test_the_compliance_is_the_way_the_tip_gives_along_a_unit_force(arm, posture_deg):
    compliance, _, feed = axial(arm, posture_deg)
    elastic = ElasticJoints(
        joints=tuple(range(6)),
        stiffness_n_m_per_rad=np.array(K),
        damping_n_m_s_per_rad=np.zeros(6),
    )
    q = model_angles(np.deg2rad(posture_deg))[None]
    moved = deflect(ArmBatch(arm), elastic, q, [*feed, 0.0, 0.0, 0.0], tool_m=TIP_M)
    assert compliance == pytest.approx(float(moved.displacement_m[0] @ feed), rel=1e-9)


def test_the_mass_is_twice_the_kinetic_energy_of_a_tip_that_moves_along_the_feed_alone(arm):
    """Six joints: one joint motion moves the tip at 1 m/s along the feed and turns it nowhere."""
    posture_deg = TRIALS[1][0]
    _, mass, feed = axial(arm, posture_deg)
    q = model_angles(np.deg2rad(posture_deg))[None]
    batch = ArmBatch(arm)
    J = batch.unit_motions(q, TIP_M)[0][:, :, 0]
    rates = np.linalg.solve(J, [*feed, 0.0, 0.0, 0.0])
    assert mass == pytest.approx(float(rates @ batch.mass(q)[:, :, 0] @ rates), rel=1e-9)
    # Freed to turn and slip, the tip takes the arm along less.
    free = minimize(
        lambda v: 0.5 * v @ batch.mass(q)[:, :, 0] @ v,
        rates,
        constraints={"type": "eq", "fun": lambda v: feed @ J[:3] @ v - 1.0},
    )
    assert 2.0 * free.fun < mass


def test_no_published_figure_differs_and_what_is_not_printed_is_said(arm):
    figures = figures_fanuc(arm)
    assert not [f for f in figures if f.status is Status.DIFFERS]
    velocities = [f for f in figures if f.unit == "mm/s"]
    assert len(velocities) == 9
    open_ones = {f.item: f.why for f in figures if f.status is Status.NOT_DERIVABLE}
    assert "593 to 1144 N" in open_ones["thrust of every trial"]
