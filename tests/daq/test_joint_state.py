from __future__ import annotations

import math

import numpy as np
import pytest

from armodal.daq.joint_state import JointState
from armodal.protocols.can_database import CanEncoder
from armodal.protocols.can_records import CanFrame

# The shipped database resolves better than this.
RESOLUTION_RAD = math.radians(0.001)


@pytest.fixture
def names(arm):
    return [joint.name for joint in arm.joints]


@pytest.fixture
def state(arm, names):
    return JointState(arm.can, names)


@pytest.fixture
def cycle(arm, names):
    encoder = CanEncoder(arm.can)

    def frames(angle_rad: float, counter: int, drive_state: int = 2) -> tuple[CanFrame, ...]:
        return encoder.encode(
            dict.fromkeys(names, angle_rad), drive_state=drive_state, counter=counter
        )

    return frames


def test_no_angle_is_assumed_before_every_joint_was_heard(state, cycle):
    first, *others = cycle(0.1, 1)
    state.feed([first], 1.0)
    assert state.reading(1.0).joints_rad is None
    assert len(state.absent) == 4
    assert math.isinf(state.reading(1.0).age_s)
    state.feed(others, 1.0)
    np.testing.assert_allclose(state.reading(1.0).joints_rad, 0.1, atol=RESOLUTION_RAD)


def test_angles_become_stale_after_the_time_in_the_arm_file(state, cycle, arm):
    state.feed(cycle(0.1, 1), 1.0)
    limit = arm.can.stale_after_s
    assert state.reading(1.0 + 0.99 * limit).joints_rad is not None
    late = state.reading(1.0 + 1.01 * limit)
    assert late.joints_rad is None
    assert late.age_s == pytest.approx(1.01 * limit)


def test_the_age_is_that_of_the_oldest_joint(state, cycle):
    state.feed(cycle(0.1, 1), 1.0)
    state.feed(cycle(0.1, 2)[1:], 1.05)
    assert state.reading(1.05).age_s == pytest.approx(0.05)


def test_a_controller_that_repeats_itself_becomes_stale(state, cycle, arm):
    for k in range(20):
        state.feed(cycle(0.1, 7), 1.0 + 0.01 * k)
    assert state.reading(1.0 + 2.0 * arm.can.stale_after_s).joints_rad is None


def test_skipped_counters_and_short_frames_are_counted(state, cycle):
    state.feed(cycle(0.1, 1), 1.0)
    state.feed(cycle(0.1, 5), 1.1)
    assert state.lost == 9  # three cycles of three messages
    first = cycle(0.1, 6)[0]
    state.feed([CanFrame(can_id=first.can_id, extended=False, data=first.data[:3])], 1.2)
    assert state.invalid == 1


def test_before_and_after_a_hit_are_the_angles_of_those_times(state, cycle):
    for k in range(10):
        state.feed(cycle(0.01 * k, k), 0.01 * k)
    before = state.reading_before(0.045)
    assert before.joints_rad is not None
    np.testing.assert_allclose(before.joints_rad, 0.04, atol=RESOLUTION_RAD)
    assert before.age_s == pytest.approx(0.005)
    after = state.reading_after(0.065)
    assert after is not None
    np.testing.assert_allclose(after.joints_rad, 0.07, atol=RESOLUTION_RAD)
    assert state.reading_after(0.09) is None
    assert state.reading_before(-1.0).joints_rad is None


def test_a_cycle_that_began_before_the_end_of_the_hit_is_not_after_it(state, cycle):
    first, *others = cycle(0.1, 1)
    state.feed([first], 1.0)
    state.feed(others, 1.02)
    assert state.reading_after(1.01) is None


def test_spread_is_known_only_over_a_time_that_was_listened_to(state, cycle):
    for k in range(10):
        state.feed(cycle(0.01 * k, k), 0.1 * k)
    assert state.spread_rad(0.5) == pytest.approx(0.04, abs=2 * RESOLUTION_RAD)
    assert state.spread_rad(-0.1) is None


def test_drives_that_do_not_hold_are_told(state, cycle):
    state.feed(cycle(0.1, 1, drive_state=2), 1.0)
    assert state.reading(1.0).held
    state.feed(cycle(0.1, 2, drive_state=0), 1.01)
    assert not state.reading(1.01).held


def test_silence_is_time_in_which_frames_are_missing(state, cycle):
    for i in range(20):
        state.feed(cycle(0.1, i), 1.0 + 0.008 * i)
    assert state.silence_s(1.0, 1.152) < 0.009
    state.feed(cycle(0.1, 20), 1.352)
    # 0.2 s without a cycle, the last one counted in.
    assert state.silence_s(1.0, 1.352) == pytest.approx(0.2, abs=0.01)


def test_frames_that_are_read_late_are_no_silence(state, cycle):
    state.feed(cycle(0.1, 0), 1.0)
    for i in range(25):
        state.feed(cycle(0.1, 1 + i), 1.2)
    assert state.silence_s(1.0, 1.2) == 0.0
