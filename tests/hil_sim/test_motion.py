import numpy as np
import pytest

from armodal.hil_sim.motion import Motion


def test_a_motion_keeps_the_speed_limit_and_reaches_it():
    motion = Motion.plan([0.0, 1.0], [2.0, 0.5], begin_s=5.0, max_speed_rad_s=1.5)
    t = np.linspace(5.0, motion.end_s, 2001)
    q = np.array([motion.joints_rad(x) for x in t])
    fastest = np.abs(np.gradient(q, t, axis=0)).max()
    # Differences over 1/2000 of the motion: error of second order, below 1e-6 of the speed.
    assert fastest == pytest.approx(1.5, rel=1e-5)


def test_a_motion_begins_and_ends_at_rest_where_it_should():
    motion = Motion.plan([0.0], [1.0], begin_s=5.0, max_speed_rad_s=1.0)
    assert motion.joints_rad(4.0) == [0.0]
    assert motion.joints_rad(motion.end_s + 1.0) == [1.0]
    # Ten s^3 of the profile: 1e-3 of the duration moves 1e-8 of the way.
    assert motion.joints_rad(5.0 + 1e-3 * motion.duration_s)[0] == pytest.approx(1e-8, rel=0.01)


def test_no_distance_takes_no_time():
    motion = Motion.plan([1.0], [1.0], begin_s=5.0, max_speed_rad_s=1.0)
    assert not motion.moving(5.0)
