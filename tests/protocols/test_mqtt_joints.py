"""Where joint angles are in a broker's messages: the file, and messages of any kind."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.errors import ControllerError
from armodal.protocols.mqtt_joints import load_mqtt_joints, mqtt_joints_from_text

TEXT = """
format = "armodal-mqtt-1"
broker = "192.168.1.20:1883"
topic = "cell/robot/state"
joints = "robot.axes"
unit = "deg"
rate_hz = 50.0
time = "stamp"
time_unit = "ms"
held = "robot.mode"
held_values = ["AUTO", 7]
"""
MESSAGE = {"stamp": 12_500, "robot": {"axes": [10, 20.5, -30], "mode": "AUTO"}}


def told(message, n_joints=3, text=TEXT):
    data = message if isinstance(message, bytes) else json.dumps(message).encode()
    return mqtt_joints_from_text(text, origin="MQTT file m.toml").sample(data, n_joints)


def test_a_message_tells_angles_time_and_state():
    found = told(MESSAGE)
    assert found.joints_rad == pytest.approx([math.radians(a) for a in (10, 20.5, -30)])
    assert (found.timestamp_s, found.held, found.drive_state) == (12.5, True, None)


def test_angles_may_stand_one_by_one():
    text = TEXT.replace('"robot.axes"', '["robot.axes.2", "stamp"]').replace('"deg"', '"rad"')
    assert told(MESSAGE, 2, text).joints_rad == (-30.0, 12_500.0)


@pytest.mark.parametrize(
    ("mode", "held", "state"),
    [("AUTO", True, None), ("TEACH", False, None), (7, True, 7), (8, False, 8), ("7", False, None)],
)
def test_the_arm_is_held_where_the_file_says_so(mode, held, state):
    message = MESSAGE | {"robot": MESSAGE["robot"] | {"mode": mode}}
    found = told(message)
    assert (found.held, found.drive_state) == (held, state)


def test_without_a_state_the_arm_is_held_and_without_a_clock_no_time_is_told():
    keys = ("time", "held")
    text = "\n".join(line for line in TEXT.splitlines() if not line.startswith(keys))
    found = told({"robot": {"axes": [0, 0, 0]}}, text=text)
    assert (found.timestamp_s, found.held, found.drive_state) == (None, True, None)


@pytest.mark.parametrize(
    "message",
    [
        b"",
        b"[" * 100_000,
        b"\xff",
        {},
        MESSAGE | {"stamp": None},
        MESSAGE | {"stamp": "now"},
        MESSAGE | {"robot": {"axes": [1, 2], "mode": "AUTO"}},
        MESSAGE | {"robot": {"axes": [1, 2, "3"], "mode": "AUTO"}},
        MESSAGE | {"robot": {"axes": [1, 2, True], "mode": "AUTO"}},
        MESSAGE | {"robot": {"axes": [1, 2, math.inf], "mode": "AUTO"}},
        MESSAGE | {"robot": {"axes": [1, 2, 3]}},
        MESSAGE | {"robot": {"axes": [1, 2, 3], "mode": 7.5}},
    ],
)
def test_a_message_that_lacks_anything_tells_nothing(message):
    assert told(message) is None


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_none(data):
    assert told(data) is None


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["stamp", "robot", "axes", "mode"]), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(json_values)
def test_any_json_tells_all_angles_or_nothing(value):
    found = told(json.dumps(value).encode())
    assert found is None or all(map(math.isfinite, (*found.joints_rad, found.timestamp_s)))


@pytest.mark.parametrize(
    ("change", "to", "words"),
    [
        ('"192.168.1.20:1883"', '"host:port"', "broker"),
        ('"cell/robot/state"', '"cell/#"', "topic"),
        ('unit = "deg"', 'unit = "gon"', "unit"),
        ("rate_hz = 50.0", "rate_hz = 0", "rate_hz"),
        ('"robot.axes"', '"robot..axes"', "joints"),
        ('held_values = ["AUTO", 7]', "", "held with held_values, or neither"),
        ('held = "robot.mode"', "", "held with held_values, or neither"),
        ('format = "armodal-mqtt-1"', 'format = "armodal-mqtt-2"', "format"),
        ('time_unit = "ms"', 'time_unit = "min"', "time_unit"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused(change, to, words):
    with pytest.raises(ControllerError, match=words):
        told(MESSAGE, text=TEXT.replace(change, to))


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(ControllerError, match=r"MQTT file .*m\.toml"):
        load_mqtt_joints(tmp_path / "m.toml")
