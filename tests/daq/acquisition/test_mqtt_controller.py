"""A controller that publishes to an MQTT broker: heard, judged by, never published to."""

import math
import multiprocessing
import socket
import threading
import time
from contextlib import closing

import numpy as np
import pytest
from support.acquisition_run import strike
from support.fake_session import SCALE, settings_of, whole_session
from support.mqtt_broker import CONNECT, DISCONNECT, PINGREQ, PUBLISH, SUBSCRIBE, MqttBroker

from armodal.daq.clock import SystemClock
from armodal.daq.commands import Stop
from armodal.daq.controllers.mqtt import MqttController, MqttSource
from armodal.daq.events import DeviceTrouble, Finished, JointsSeen
from armodal.daq.lab_watch import run_lab_watch
from armodal.daq.open_joints import hear_every_joint
from armodal.protocols.errors import (
    CanError,
    ControllerError,
    DeviceLostError,
    DeviceTimeoutError,
    MissingPackageError,
)
from armodal.protocols.mqtt_joints import mqtt_joints_from_text
from armodal.protocols.session.journal import load_journal

NAMES = [f"joint {i + 1}" for i in range(6)]
JOINTS_RAD = (0.1, -0.2, 0.3, -0.4, 0.5, -0.6)
RATE_HZ = 50.0
TEXT = """
format = "armodal-mqtt-1"
broker = "{broker}"
topic = "cell/state"
joints = "q"
unit = "deg"
rate_hz = 50.0
time = "t"
held = "mode"
held_values = ["HELD"]
"""

pytest.importorskip("paho.mqtt.client")


def wanted(address):
    return mqtt_joints_from_text(TEXT.format(broker=address), origin="MQTT file m.toml")


class Controller:
    """What the broker is told."""

    def __init__(self, joints_rad=JOINTS_RAD):
        self.joints_rad, self.mode = tuple(joints_rad), "HELD"

    def __call__(self, t_s):
        return {"t": t_s, "q": [math.degrees(a) for a in self.joints_rad], "mode": self.mode}


@pytest.fixture
def serve():
    brokers = []

    def begin(tell=None, **how):
        brokers.append(MqttBroker(tell or Controller(), rate_hz=RATE_HZ, **how))
        return brokers[-1]

    yield begin
    for broker in brokers:
        broker.close()


@pytest.fixture
def by_mqtt(lab, start, serve):
    """A session whose angles come from a broker beside the fake board."""
    lab.controller.unplug()  # there is no bus
    broker = serve(Controller(lab.plan.postures[0].joints_rad))
    return broker, lambda **changes: start(
        can_channel="", controller=MqttController(wanted=wanted(broker.address)), **changes
    )


def hear_until(source, done, seconds=5.0):
    clock = SystemClock()
    until_s = clock.now_s() + seconds
    while not done() and clock.now_s() < until_s:
        clock.wait([source.fileno()], 0.1)
        source.collect(clock.now_s())
        source.hear()
    assert done()


def test_angles_come_with_the_controller_s_own_gaps_counted(serve):
    broker = serve()
    with closing(MqttSource(wanted(broker.address), NAMES)) as source:
        hear_every_joint(source, SystemClock(), 5.0)
        np.testing.assert_allclose(
            source.joints.reading(SystemClock().now_s()).joints_rad, JOINTS_RAD, atol=1e-12
        )
        broker.t_s += 3.0 / RATE_HZ  # three that nobody saw
        hear_until(source, lambda: source.joints.lost)
        assert source.joints.lost == 3
        assert source.faults == 0


def test_messages_that_come_between_two_looks_are_all_heard_at_the_second(serve):
    broker = serve()
    with closing(MqttSource(wanted(broker.address), NAMES)) as source:
        hear_every_joint(source, SystemClock(), 5.0)
        broker.rate_hz = 1_000.0
        told_before, heard_before = broker.told, source.joints.frames
        while broker.told < told_before + 100:
            time.sleep(0.01)
        source.collect(SystemClock().now_s())
        source.hear()
        assert source.joints.frames >= heard_before + 99


def test_what_the_broker_has_kept_is_not_believed(serve):
    broker = serve(kept={"t": 1.0, "q": [0.0] * 6, "mode": "HELD"})
    broker.silent = True
    with closing(MqttSource(wanted(broker.address), NAMES)) as source:
        with pytest.raises(CanError, match="had kept is not believed"):
            hear_every_joint(source, SystemClock(), 0.3)
        broker.silent = False
        hear_every_joint(source, SystemClock(), 5.0)
        assert source.joints.reading(SystemClock().now_s()).joints_rad[0] == pytest.approx(0.1)


def test_messages_that_cannot_be_read_are_counted_and_said(serve):
    broker = serve(lambda t_s: {"t": t_s, "angles": [1, 2, 3]})
    with (
        closing(MqttSource(wanted(broker.address), NAMES)) as source,
        pytest.raises(CanError, match="none with 6 angles where the MQTT file says"),
    ):
        hear_every_joint(source, SystemClock(), 0.3)


@pytest.mark.parametrize(
    ("how", "error", "words"),
    [
        ({"refuses": True}, ControllerError, "refuses .*let it allow readers"),
        ({"grants": False}, ControllerError, "refuses .*no subscription to cell/state"),
        ({"mute": True}, DeviceTimeoutError, "does not answer as an MQTT broker"),
    ],
)
def test_a_broker_that_does_not_do_what_is_wanted_is_told(serve, monkeypatch, how, error, words):
    monkeypatch.setattr("armodal.daq.controllers.mqtt.ANSWER_WALL_S", 0.5)
    broker = serve()
    for name, value in how.items():
        setattr(broker, name, value)
    with pytest.raises(error, match=words):
        MqttSource(wanted(broker.address), NAMES)


def test_nobody_at_an_address_is_told():
    with socket.create_server(("127.0.0.1", 0)) as nobody:
        port = nobody.getsockname()[1]
    with pytest.raises(ControllerError, match="cannot be reached"):
        MqttSource(wanted(f"127.0.0.1:{port}"), NAMES)


def test_a_missing_package_is_told_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "paho.mqtt.client", None)
    with pytest.raises(MissingPackageError, match=r"pip install 'armodal\[mqtt\]'"):
        MqttSource(wanted("127.0.0.1"), NAMES)


def test_a_broker_that_goes_is_lost(serve):
    broker = serve()
    with closing(MqttSource(wanted(broker.address), NAMES)) as source:
        hear_every_joint(source, SystemClock(), 5.0)
        broker.close()
        with pytest.raises(DeviceLostError, match="is gone"):
            hear_until(source, lambda: False)


def test_a_hit_is_judged_by_the_angles_told(lab, by_mqtt, fakes):
    broker, start = by_mqtt
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    hit = run.judged()
    assert hit.verdict.accepted
    np.testing.assert_allclose(hit.before.joints_rad, broker.tell.joints_rad, atol=1e-12)
    run.end()
    assert load_journal(lab.journal).header.told_tolerance_rad is None


def test_an_arm_let_go_or_moved_rejects_the_hit(lab, by_mqtt, fakes):
    broker, start = by_mqtt
    run = start()
    run.ready()
    broker.tell.mode = "TEACH"
    time.sleep(len(fakes["record"]()) / 1652.0)
    broker.tell.joints_rad = tuple(np.array(broker.tell.joints_rad) + math.radians(0.3))
    lab.board.hit(fakes["record"]())
    assert {"moved", "not-held"} <= set(run.judged().verdict.reasons)


def test_a_controller_that_falls_silent_rejects_the_hit(lab, by_mqtt, fakes):
    broker, start = by_mqtt
    run = start()
    run.ready()
    broker.silent = True
    run.noted("silent")
    strike(lab, fakes["record"]())
    assert "stale" in run.judged().verdict.reasons


def test_nothing_is_published_over_a_whole_session(lab, fakes, serve):
    lab.controller.unplug()
    broker = serve(Controller(lab.plan.postures[0].joints_rad), scale=SCALE)
    end, code = whole_session(
        lab,
        fakes["record"](),
        can_channel="",
        controller=MqttController(wanted=wanted(broker.address)),
        can_timeout_s=60.0,
    )
    assert isinstance(end, Finished)
    assert (code, end.complete) == (0, True)
    broker.until(DISCONNECT)
    broker.close()
    assert broker.received[PUBLISH] == 0
    assert set(broker.received) - {PINGREQ} == {CONNECT, SUBSCRIBE, DISCONNECT}
    assert not broker.will  # nothing is published for us when we go, either


def test_before_a_session_the_broker_is_watched_too(lab, serve):
    broker = serve(Controller(lab.plan.postures[0].joints_rad))
    ours, theirs = multiprocessing.Pipe()
    settings = settings_of(
        lab,
        can_channel="",
        controller=MqttController(wanted=wanted(broker.address)),
        time_scale=1.0,
    )
    watch = threading.Thread(target=run_lab_watch, args=(settings, theirs))
    watch.start()
    while not (isinstance(event := ours.recv(), JointsSeen) and event.reading.held):
        assert not isinstance(event, DeviceTrouble) or event.message is None
    ours.send(Stop())
    watch.join(5.0)
    np.testing.assert_allclose(event.reading.joints_rad, broker.tell.joints_rad, atol=1e-12)
    assert broker.received[PUBLISH] == 0
