"""Logs of motion in MCAP files and rosbags: what comes back, and what is told of a faulty one."""

import sys

import numpy as np
import pytest
from support.motion_bags import WRITERS, mcap_cdr
from support.quick import few_quick

from armodal.protocols.errors import ForeignFileError, MissingPackageError
from armodal.protocols.foreign.read_motion import read_motion_log

pytest.importorskip("mcap")
pytest.importorskip("rosbags")

BEGUN_NS = 1_700_000_000_000_000_000
SECONDS = 2.0


def smooth(t, arm):
    """Angles in rad within every range, and readings of an accelerometer, at times t."""
    middle = np.array([np.mean(joint.range_rad) for joint in arm.joints])
    number = np.arange(len(arm.joints))
    angles = middle + 0.1 * np.sin(2 * np.pi * (1.0 + number) * t[:, None] + number)
    readings = np.stack([np.sin(2 * np.pi * f * t) for f in (5.0, 9.0, 14.0)], axis=1)
    return angles, readings


def topics(arm, *, joints_hz=250.0, imu_hz=1000.0, jitter=0.0, late_s=0.0003):
    rng = np.random.default_rng(3)
    t_joints = np.arange(0.0, SECONDS, 1.0 / joints_hz)
    t_imu = late_s + np.arange(0.0, SECONDS, 1.0 / imu_hz)
    names = [joint.name for joint in arm.joints]
    stamp_joints = t_joints + jitter / joints_hz * rng.uniform(-1.0, 1.0, len(t_joints))
    # Another order of joints, with one that is not the arm's.
    order = [*names[::-1], "gripper"]
    angles = np.column_stack([smooth(t_joints, arm)[0][:, ::-1], np.zeros(len(t_joints))])
    return [
        ["/joint_states", order, in_ns(stamp_joints), angles],
        ["/arm/acc_1", "tool", in_ns(t_imu), smooth(t_imu, arm)[1]],
    ]


def in_ns(t):
    return BEGUN_NS + np.round(1e9 * t).astype(np.int64)


@pytest.mark.parametrize("kind", few_quick(WRITERS, "rosbag 2", "MCAP with JSON"))
def test_angles_and_accelerations_come_back_on_one_even_clock(arm, not_apart, tmp_path, kind):
    log = read_motion_log(WRITERS[kind](tmp_path / "log", topics(arm)), arm)
    assert log.rate_hz == pytest.approx(1000.0, rel=1e-6)
    assert log.slowest_hz == pytest.approx(250.0, rel=1e-6)
    t = 0.0003 + np.arange(len(log.angles_rad)) / 1000.0
    angles, readings = smooth(t, arm)
    # Stamps are whole ns; the curve between 250 rows a second is off by (2 pi 6/250)^6 or so at
    # its ends, where it has no rows on one side.
    np.testing.assert_allclose(log.encoder_rad, angles, atol=2e-6)
    assert log.command_rad is None
    np.testing.assert_allclose(log.acceleration_m_s2["1"], readings, atol=1e-6)
    assert log.unused == ()


def test_an_accelerometer_is_known_by_its_frame_and_commands_by_their_topic(
    arm, not_apart, tmp_path
):
    joints, imu = topics(arm)
    imu[0], imu[1] = "/imu/data", "acc_1"
    commands = ["/joint_commands", *joints[1:3], joints[3] + 0.01]
    log = read_motion_log(mcap_cdr(tmp_path / "log", [joints, imu, commands]), arm)
    np.testing.assert_allclose(log.command_rad - log.encoder_rad, 0.01, atol=1e-9)
    assert set(log.acceleration_m_s2) == {"1"}


def test_topics_of_any_name_are_what_the_user_says(arm, not_apart, tmp_path):
    joints, imu = topics(arm)
    joints[0], imu[0] = "/desired", "/sensor"
    path = mcap_cdr(tmp_path / "log", [joints, imu, ["/other", "imu_link", *imu[2:]]])
    log = read_motion_log(path, arm, {"encoder": "/desired", "2": "/sensor"})
    assert log.encoder_rad is not None
    assert set(log.acceleration_m_s2) == {"2"}
    assert log.unused == ("/other",)


def test_stamps_that_jitter_are_read_as_even_and_told(arm, not_apart, tmp_path):
    path = mcap_cdr(tmp_path / "log", topics(arm, jitter=0.2))
    log = read_motion_log(path, arm)
    angles, _ = smooth(0.0003 + np.arange(len(log.angles_rad)) / 1000.0, arm)
    # The line through 500 stamps is off by their scatter over sqrt(500) steps, at its ends twice
    # that: 0.2/sqrt(3)/sqrt(500)*2/250 s at up to 0.1 * 2 pi 6 rad/s, and four of them.
    off = 4 * 2 * 0.2 / np.sqrt(3 * 500) / 250 * 0.1 * 2 * np.pi * 6
    np.testing.assert_allclose(log.encoder_rad, angles, atol=off)
    assert "stamps of /joint_states are up to 0.2" in " ".join(log.notes)


def refused(path, arm, roles=None):
    with pytest.raises(ForeignFileError) as told:
        read_motion_log(path, arm, roles)
    return str(told.value)


def test_what_lacks_is_named_at_once_with_the_topics_there_are(arm, not_apart, tmp_path):
    joints, imu = topics(arm)
    imu[0] = "/imu/data"
    joints[1] = joints[1][1:]
    joints[3] = joints[3][:, 1:]
    said = refused(mcap_cdr(tmp_path / "log", [joints, imu]), arm)
    for part in ("JointState messages with", "Imu or Accel", "/joint_states (joints)", "/imu/data"):
        assert part in said
    said = refused(tmp_path / "log.mcap", arm, {"1": "/none", "encoder": "/joint_states", "p": "/"})
    for part in ("a topic /none for 1", "not 'p'", f"the joints {arm.joints[-1].name} in"):
        assert part in said


def test_two_topics_for_one_thing_are_not_guessed_between(arm, not_apart, tmp_path):
    joints, imu = topics(arm)
    said = refused(mcap_cdr(tmp_path / "log", [joints, imu, ["/second", *joints[1:]]]), arm)
    assert "one topic for encoder, not /joint_states and /second" in said
    assert "--topic encoder=TOPIC" in said


def test_jumps_of_a_clock_and_lost_messages_are_told_by_topic(arm, not_apart, tmp_path):
    joints, imu = topics(arm)
    joints[2][300:] += 5 * 10**8
    kept = np.delete(np.arange(len(imu[2])), [700, 900])
    imu[2:] = [imu[2][kept], imu[3][kept]]
    said = refused(mcap_cdr(tmp_path / "log", [joints, imu]), arm)
    assert "4 ms apart on /joint_states as most are, got 504 ms after message 300" in said
    assert "1 ms apart on /arm/acc_1 as most are, got 2 ms after message 700 and 2 such" in said


def test_logs_of_different_times_and_other_units_are_told(arm, not_apart, tmp_path):
    joints, imu = topics(arm)
    imu[2] = imu[2] + 10**11
    assert "log all at the same time" in refused(mcap_cdr(tmp_path / "a", [joints, imu]), arm)
    joints, imu = topics(arm)
    joints[3] = np.rad2deg(joints[3] + 1.0)
    imu[3] = imu[3] * 0.1 + np.array([0.0, 0.6, -0.8])
    said = refused(mcap_cdr(tmp_path / "b", [joints, imu]), arm)
    assert "joint_1 within" in said
    assert "gravity in g" in said


@pytest.mark.parametrize("kind", few_quick(WRITERS, "rosbag 1", "MCAP with CDR"))
@pytest.mark.parametrize(
    "part", [0.5, *(pytest.param(p, marks=pytest.mark.long) for p in (0.0, 0.1))]
)
def test_a_damaged_file_is_one_message(arm, tmp_path, kind, part):
    path = WRITERS[kind](tmp_path / "log", topics(arm))
    file = next(path.glob("*.db3")) if path.is_dir() else path
    data = file.read_bytes()
    file.write_bytes(data[: int(part * len(data))])
    assert "cannot be read" in refused(path, arm)


def test_a_file_that_is_not_there_and_topics_of_a_csv_are_refused(arm, tmp_path):
    assert "found no such file" in refused(tmp_path / "none.mcap", arm)
    (tmp_path / "log.csv").write_text("time_s,here\n0,1\n1,2\n")
    assert "with a CSV log" in refused(tmp_path / "log.csv", arm, {"encoder": "/a"})


def test_without_the_packages_there_is_one_clear_message(arm, tmp_path, monkeypatch):
    path = mcap_cdr(tmp_path / "log", topics(arm))
    monkeypatch.setitem(sys.modules, "mcap.reader", None)
    with pytest.raises(MissingPackageError, match=r"armodal\[logs\]"):
        read_motion_log(path, arm)
