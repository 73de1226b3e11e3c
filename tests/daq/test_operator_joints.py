import math
from types import SimpleNamespace

import numpy as np
import pytest

from armodal.daq.commands import StatedPosture
from armodal.daq.joint_source import CanJoints
from armodal.daq.joint_state import JointState
from armodal.daq.open_joints import check_told
from armodal.daq.operator_joints import OperatorSource, posture_refusal
from armodal.protocols.errors import PlanError

TOLD_RAD = math.radians(0.2)


@pytest.fixture
def posture(plan):
    (posture,) = plan.postures  # to be kept to 0.5 deg
    return posture


def word_off(posture, off_deg):
    joints_rad = posture.joints_rad.copy()
    joints_rad[2] += math.radians(off_deg)
    return StatedPosture(joints_rad=tuple(joints_rad))


def test_nothing_is_known_before_it_is_told(posture):
    source = OperatorSource(TOLD_RAD)
    assert source.joints.reading(1.0).joints_rad is None
    assert source.joints.spread_rad(0.0) is None
    source.take_posture(StatedPosture(), posture, 2.0)
    assert source.joints.reading_before(1.9).joints_rad is None
    told = source.joints.reading_before(5.0)
    np.testing.assert_array_equal(told.joints_rad, posture.joints_rad)
    assert (told.held, told.age_s) == (True, 3.0)


def test_what_was_told_of_a_posture_ends_with_it(posture):
    source = OperatorSource(TOLD_RAD)
    source.take_posture(StatedPosture(), posture, 2.0)
    source.begin_posture()
    assert source.joints.reading(3.0).joints_rad is None


def test_angles_typed_are_kept_as_they_were_typed(posture):
    source = OperatorSource(TOLD_RAD)
    word = word_off(posture, 0.29)
    said = source.take_posture(word, posture, 2.0)
    assert "told by the operator" in said
    assert "to 0.2 deg, and held" in said
    np.testing.assert_array_equal(source.joints.reading(2.0).joints_rad, word.joints_rad)


def test_an_angle_that_may_lie_outside_the_posture_is_refused(posture):
    # 0.5 deg less the 0.2 deg that the word may be off.
    said = OperatorSource(TOLD_RAD).take_posture(word_off(posture, 0.31), posture, 2.0)
    assert "joint 3 was given 0.31 deg off posture test 1, 0.30 allowed" in said
    assert "not taken" in said


def test_too_few_angles_are_refused(posture):
    word = StatedPosture(joints_rad=(0.0, 0.0))
    assert "wanted 6 joint angles, got 2" in posture_refusal(word, posture, TOLD_RAD)


def test_a_plan_that_wants_more_than_can_be_told_is_refused(plan):
    check_told(plan, math.radians(0.5))
    with pytest.raises(PlanError, match=r"tolerance_deg \(test 1 0.5\) is closer than the 0.6 deg"):
        check_told(plan, math.radians(0.6))


def test_a_word_at_no_posture_is_not_taken():
    source = OperatorSource(TOLD_RAD)
    assert "not taken" in source.take_posture(StatedPosture(), None, 1.0)
    assert source.joints.reading(1.0).joints_rad is None


def test_a_bus_takes_no_word(arm):
    bus = CanJoints(SimpleNamespace(name="bus"), JointState(arm.can, ["joint_1"]))
    assert "measured" in bus.take_posture(StatedPosture(), None, 1.0)
