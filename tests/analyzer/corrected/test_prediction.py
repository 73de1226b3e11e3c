"""Modes of an arm file, and what of them its deviations leave uncertain."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import axis, with_effects

from armodal.analyzer.corrected.condense import condense
from armodal.analyzer.corrected.correction import correction_of, stepped
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.protocols.errors import ArmError

ARM = with_effects("rv4frl", axis("shoulder"))
DEG = (0.0, 30.0, 30.0, 0.0, 90.0, 0.0)


@pytest.mark.long
def test_the_spread_of_the_file_s_values_is_the_predicted_deviation():
    few = replace(
        ARM,
        joints=tuple(
            j
            if j.stiffness is None
            else replace(j, stiffness=replace(j.stiffness, std=0.02 * j.stiffness.value))
            for j in ARM.joints
        ),
    )
    (found,) = predict_arm(few, [DEG])
    own = correction_of(few)
    at = stand(own, np.deg2rad(DEG))
    std = {name: s for name, _, s in own.names}
    for joint in few.joints:
        if joint.stiffness is not None:
            std[f"ln k {joint.name}"] = 0.02
            std[f"ln c {joint.name}"] = joint.damping.std / joint.damping.value
    rng = np.random.default_rng(3)
    sample = [
        corrected_modes(
            corrected_posture(
                stepped(own, {name: rng.normal(0.0, s) for name, s in std.items()}), at
            )
        ).f_hz
        for _ in range(200)
    ]
    # A deviation of 200 draws is known to 5 %; three of those, and the bend of second order.
    assert found.f_std_hz == pytest.approx(np.std(sample, axis=0), rel=0.2)


def test_strain_is_shared_among_joints_and_what_effects_let_give_way():
    (found,) = predict_arm(ARM, [DEG])
    assert found.posture.names == ("joint_1", "joint_2", "joint_3", "axis compliance shoulder")
    assert found.strain_share.sum(axis=0) == pytest.approx(1.0)


def test_a_posture_out_of_range_is_refused():
    with pytest.raises(ArmError, match="joint_2"):
        predict_arm(ARM, [(0.0, 999.0, 0.0, 0.0, 0.0, 0.0)])


def test_condensing_finds_the_values_that_a_file_needs():
    own = correction_of(ARM)
    steps = {"ln k joint_1": 0.1, "ln c joint_2": -0.2, "axis compliance shoulder": 2e-6}
    found = condense(stepped(own, steps), own, ("axis compliance shoulder",), top_hz=100.0)
    k = ARM.joints[0].stiffness.value * np.exp(0.1)
    # It stops where a step changes nothing by a part in ten thousand.
    assert found.stiffness["joint_1"] == pytest.approx(k, rel=1e-3)
    assert found.damping["joint_2"] == pytest.approx(
        ARM.joints[1].damping.value * np.exp(-0.2), rel=5e-3
    )
    assert found.factors["axis compliance shoulder"] == pytest.approx(1.2, rel=2e-3)
    assert found.f_error < 1e-3
