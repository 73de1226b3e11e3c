from types import SimpleNamespace

import numpy as np
import pytest

from armodal.daq.arm_around import AFTER_WALL_S, SILENCE_S, ArmAround
from armodal.daq.clock import SystemClock
from armodal.daq.joint_state import JointState
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.can_database import CanEncoder

TURN_S = 0.02


class Bus:
    """Cycles of a controller, at times of the test's choosing."""

    def __init__(self, arm):
        self.joints = JointState(arm.can, [joint.name for joint in arm.joints])
        self._names = [joint.name for joint in arm.joints]
        self._encoder = CanEncoder(arm.can)
        self._held = arm.can.drive_state.held_values[0]
        self._counter = 0

    def cycles(self, joints_rad, times_s):
        for at_s in times_s:
            self._counter += 1
            angles = dict(zip(self._names, joints_rad.tolist(), strict=True))
            self.joints.feed(
                self._encoder.encode(angles, drive_state=self._held, counter=self._counter), at_s
            )


@pytest.fixture
def bus(arm):
    return Bus(arm)


@pytest.fixture
def around(arm, plan, bus, tmp_path):
    settings = AcquisitionSettings(
        board_port="", can_channel="", arm=arm, plan=plan, journal=tmp_path / "a.journal"
    )
    return ArmAround(settings, SystemClock(), bus.joints, TURN_S)


def block_that_came_at(seconds):
    return SimpleNamespace(last_data_s=seconds)


def test_an_arm_nobody_has_told_of_is_neither_there_nor_off(around, bus, plan):
    (posture,) = plan.postures
    assert around.is_off(posture, bus.joints.reading(1.0)) is None
    assert not around.is_still(posture, 1.0)


def test_an_arm_within_the_tolerance_is_there_and_beyond_it_is_off(around, bus, plan):
    (posture,) = plan.postures
    bus.cycles(posture.joints_rad + 0.9 * posture.tolerance_rad, [1.0])
    assert around.is_off(posture, bus.joints.reading(1.0)) is False
    bus.cycles(posture.joints_rad + 1.1 * posture.tolerance_rad, [1.008])
    assert around.is_off(posture, bus.joints.reading(1.008)) is True


def test_an_angle_read_within_a_turn_of_the_end_may_be_older_than_it(around, bus, plan):
    bus.cycles(plan.postures[0].joints_rad, [1.0, 1.0 + 0.9 * TURN_S])
    assert around.after(block_that_came_at(1.0), 1.0, 1.03) is None
    bus.cycles(plan.postures[0].joints_rad, [1.0 + 1.1 * TURN_S])
    after = around.after(block_that_came_at(1.0), 1.0, 1.03)
    assert after is not None
    assert after.joints_rad is not None


def test_without_an_angle_after_the_block_none_is_made_up(around, bus, plan):
    bus.cycles(plan.postures[0].joints_rad, [0.99])
    late_s = 1.0 + 10.0 * AFTER_WALL_S
    after = around.after(block_that_came_at(1.0), 1.0, late_s)
    assert after is not None
    assert after.joints_rad is None


def test_a_silence_of_the_bus_during_a_hit_speaks_against_it(around, bus, plan):
    (posture,) = plan.postures
    bus.cycles(posture.joints_rad, [1.0, 1.008, 1.016 + 2.0 * SILENCE_S])
    before = around.before(1.01)
    after = bus.joints.reading_after(1.02)
    reasons, _ = around.judged(before, after, posture)
    assert reasons == ("stale",)


def test_a_silence_counts_from_before_the_hit(around, bus, plan):
    (posture,) = plan.postures
    bus.cycles(posture.joints_rad, [1.0, 1.0 + 1.2 * SILENCE_S, 1.008 + 1.2 * SILENCE_S])
    before = around.before(1.0 + 0.6 * SILENCE_S)
    after = bus.joints.reading_after(1.0 + 0.7 * SILENCE_S)
    reasons, _ = around.judged(before, after, posture)
    assert reasons == ("stale",)


def test_a_steady_arm_on_a_steady_bus_has_nothing_against_it(around, bus, plan):
    (posture,) = plan.postures
    bus.cycles(posture.joints_rad, np.arange(1.0, 1.5, 0.008))
    reasons, notes = around.judged(around.before(1.1), bus.joints.reading_after(1.3), posture)
    assert (reasons, notes) == ((), ())
