"""A Universal Robots controller as a source of joint angles: heard, judged by, never written."""

import math
import multiprocessing
import socket
import threading
import time
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from support.acquisition_run import strike
from support.fake_session import SCALE, settings_of, whole_session
from support.rtde_server import RtdeServer

from armodal.daq.clock import SystemClock
from armodal.daq.commands import Stop
from armodal.daq.controllers.ur import OPTION, RATE_HZ, STALE_AFTER_S, RtdeSource, ur_joints
from armodal.daq.events import DeviceTrouble, Finished, JointsSeen
from armodal.daq.lab_watch import run_lab_watch
from armodal.daq.open_joints import hear_every_joint
from armodal.protocols.errors import (
    ArmError,
    CanError,
    ControllerError,
    DeviceLostError,
    DeviceTimeoutError,
)
from armodal.protocols.joint_sample import JointSample
from armodal.protocols.session.journal import load_journal

JOINTS_RAD = (0.1, -0.2, 0.3, -0.4, 0.5, -0.6)
LISTENS = {"V", "O", "S"}  # what asks to be told; none of them is an input


def sample(at_s, joints_rad=JOINTS_RAD, *, held=True):
    return JointSample(timestamp_s=at_s, joints_rad=joints_rad, drive_state=7, held=held)


def collect_to_the_end(source):
    clock = SystemClock()
    while clock.wait([source.fileno()], 5.0):
        source.collect(0.0)


@pytest.fixture
def serve():
    servers = []

    def begin(joints_rad=JOINTS_RAD, **how):
        servers.append(RtdeServer(joints_rad, **how))
        return servers[-1]

    yield begin
    for server in servers:
        server.close()


@pytest.fixture
def by_rtde(lab, start, serve):
    """A session whose angles come from a controller beside the fake board."""
    lab.controller.unplug()  # there is no bus
    server = serve(lab.plan.postures[0].joints_rad)
    return server, lambda **changes: start(
        can_channel="", controller=OPTION.controller(server.address), **changes
    )


def test_angles_are_known_until_they_are_stale():
    joints = ur_joints()
    assert joints.reading(1.0).joints_rad is None
    assert len(joints.absent) == 6
    joints.take(sample(50.0), 1.0)
    assert joints.absent == ()
    known = joints.reading(1.0 + 0.9 * STALE_AFTER_S)
    np.testing.assert_array_equal(known.joints_rad, JOINTS_RAD)
    late = joints.reading(1.0 + 1.1 * STALE_AFTER_S)
    assert late.joints_rad is None
    assert late.age_s == pytest.approx(1.1 * STALE_AFTER_S)


def test_a_controller_whose_clock_stands_still_tells_nothing_new():
    joints = ur_joints()
    joints.take(sample(50.0), 1.0)
    joints.take(sample(50.0), 2.0)
    assert joints.reading(2.0).joints_rad is None


def test_packages_left_out_are_counted_by_the_controller_s_clock():
    joints = ur_joints()
    for n in (0, 1, 2, 5, 6):
        joints.take(sample(50.0 + n / RATE_HZ), 1.0 + n / RATE_HZ)
    joints.take(None, 2.0)
    assert (joints.frames, joints.lost, joints.invalid) == (5, 2, 1)


def test_a_source_hears_every_joint(serve):
    server = serve()
    with closing(RtdeSource(server.address)) as source:
        hear_every_joint(source, SystemClock(), 3.0)
        np.testing.assert_array_equal(source.joints.reading_after(0.0).joints_rad, JOINTS_RAD)
    assert set(server.received) == LISTENS


@pytest.mark.parametrize(
    ("how", "kind", "words"),
    [
        ({"lacks": ("actual_q",)}, ControllerError, "actual_q NOT_FOUND in place of VECTOR6D"),
        ({"accepts": False}, ControllerError, "refuses RTDE protocol version 2"),
    ],
)
def test_a_controller_that_does_not_tell_is_refused(serve, how, kind, words):
    with pytest.raises(kind, match=words):
        RtdeSource(serve(**how).address)


def test_a_silent_listener_is_no_controller(serve, monkeypatch):
    monkeypatch.setattr("armodal.daq.controllers.ur.ANSWER_WALL_S", 0.1)
    with pytest.raises(DeviceTimeoutError, match=r"does not answer in 0.1 s: is it a Universal"):
        RtdeSource(serve(mute=True).address)


def test_nobody_at_an_address_is_told():
    with socket.create_server(("127.0.0.1", 0)) as nobody:
        port = nobody.getsockname()[1]
    with pytest.raises(ControllerError, match=f"nothing listens on port {port}"):
        RtdeSource(f"127.0.0.1:{port}")


@pytest.mark.parametrize("address", ["", ":30004", "ur:0", "ur:70000", "ur:abc"])
def test_an_address_that_is_none_is_refused(address):
    with pytest.raises(ControllerError, match="HOST or HOST:PORT"):
        RtdeSource(address)


def test_a_controller_that_tells_nothing_after_all_is_said(serve):
    server = serve()
    server.silent = True
    with (
        closing(RtdeSource(server.address)) as source,
        pytest.raises(CanError, match="accepted to tell joint angles and tells none"),
    ):
        hear_every_joint(source, SystemClock(), 0.01)


def test_a_controller_that_goes_is_lost(serve):
    server = serve()
    with closing(RtdeSource(server.address)) as source:
        while source.joints.absent:
            source.collect(0.0)
            source.hear()
        server.close()
        with pytest.raises(DeviceLostError, match="is gone"):
            collect_to_the_end(source)


def test_an_arm_of_other_joints_is_refused(arm):
    with pytest.raises(ArmError, match="tells 6 angles"):
        OPTION.controller("127.0.0.1").open(replace(arm, joints=arm.joints[:5]))


def test_a_hit_is_judged_by_the_controller_s_angles(lab, by_rtde, fakes):
    server, start = by_rtde
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    hit = run.judged()
    assert hit.verdict.accepted
    np.testing.assert_array_equal(hit.before.joints_rad, server.joints_rad)
    run.end()
    assert load_journal(lab.journal).header.told_tolerance_rad is None


def test_an_arm_led_by_hand_or_moved_rejects_the_hit(lab, by_rtde, fakes):
    server, start = by_rtde
    run = start()
    run.ready()
    server.status_bits = 0b101  # teach button
    time.sleep(len(fakes["record"]()) / 1652.0)
    server.joints_rad = tuple(np.array(server.joints_rad) + math.radians(0.3))
    lab.board.hit(fakes["record"]())
    assert {"moved", "not-held"} <= set(run.judged().verdict.reasons)


def test_a_controller_that_falls_silent_rejects_the_hit(lab, by_rtde, fakes):
    server, start = by_rtde
    run = start()
    run.ready()
    server.silent = True
    run.noted("silent")
    strike(lab, fakes["record"]())
    assert "stale" in run.judged().verdict.reasons
    server.silent = False
    run.noted("back")


def test_nothing_but_requests_to_listen_is_sent_over_a_whole_session(lab, fakes, serve):
    lab.controller.unplug()
    server = serve(lab.plan.postures[0].joints_rad, scale=SCALE)
    end, code = whole_session(
        lab,
        fakes["record"](),
        can_channel="",
        controller=OPTION.controller(server.address),
        can_timeout_s=60.0,
    )
    assert isinstance(end, Finished)
    assert (code, end.complete) == (0, True)
    assert server.received == {"V": 1, "O": 1, "S": 1}


def test_before_a_session_the_controller_is_watched_too(lab, serve):
    server = serve(lab.plan.postures[0].joints_rad)
    ours, theirs = multiprocessing.Pipe()
    settings = settings_of(
        lab, can_channel="", controller=OPTION.controller(server.address), time_scale=1.0
    )
    watch = threading.Thread(target=run_lab_watch, args=(settings, theirs))
    watch.start()
    while not (isinstance(event := ours.recv(), JointsSeen) and event.reading.held):
        assert not isinstance(event, DeviceTrouble) or event.message is None
    ours.send(Stop())
    watch.join(5.0)
    np.testing.assert_array_equal(event.reading.joints_rad, server.joints_rad)
    assert set(server.received) == LISTENS
