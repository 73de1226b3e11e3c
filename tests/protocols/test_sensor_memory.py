"""Sensors and the sensitivities they were last used with."""

from dataclasses import replace

import pytest
from support.channels import channel

from armodal.protocols.errors import SessionError
from armodal.protocols.sensor_memory import load_sensors, remember_sensors, unlike_before

RANGE_V = 5.0
HAMMER = replace(
    channel("hammer", "force", scale=1e-4),
    full_scale=2222.2,
    serial_number="H-1",
    calibration_date="2026-03-02",
)
DAY = "2026-11-26"


@pytest.fixture
def memory(tmp_path):
    path = tmp_path / "there is" / "no such folder" / "sensors.json"
    remember_sensors(path, [HAMMER], RANGE_V, DAY)
    return path


def test_a_sensor_used_as_before_is_not_mentioned(memory):
    # 2.25 mV/N typed with three digits is within what sensitivities are told to.
    again = replace(HAMMER, full_scale=1e3 * RANGE_V / 2.253)
    assert unlike_before([HAMMER, again], RANGE_V, load_sensors(memory)) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"full_scale": 222.22}, "hammer: 22.5 mV per N, and sensor H-1 had 2.25 when it was last"),
        ({"scale": -1e-4}, "hammer: -2.25 mV per N, and sensor H-1 had 2.25 when it was last used"),
    ],
)
def test_another_sensitivity_or_sign_is_told_with_the_one_before(memory, change, words):
    (said,) = unlike_before([replace(HAMMER, **change)], RANGE_V, load_sensors(memory))
    assert words in said
    assert said.endswith(f"on {DAY}")


def test_a_sensor_calibrated_since_may_have_another(memory):
    since = replace(HAMMER, full_scale=2000.0, calibration_date="2026-11-01")
    assert unlike_before([since], RANGE_V, load_sensors(memory)) == []
    remember_sensors(memory, [since], RANGE_V, DAY)
    assert unlike_before([since], RANGE_V, load_sensors(memory)) == []
    assert unlike_before([HAMMER], RANGE_V, load_sensors(memory)) != []


def test_what_is_not_known_contradicts_nothing(memory):
    known = load_sensors(memory)
    other = replace(HAMMER, full_scale=1.0, serial_number="H-2")
    nameless = replace(HAMMER, full_scale=1.0, serial_number="")
    axis = replace(HAMMER, full_scale=1.0, name="another axis of one number")
    assert unlike_before([other, nameless, axis], RANGE_V, known) == []
    assert unlike_before([replace(HAMMER, full_scale=1.0)], None, known) == []


def test_others_stay_remembered(memory):
    remember_sensors(memory, [replace(HAMMER, serial_number="H-2")], RANGE_V, DAY)
    remember_sensors(memory, [replace(HAMMER, serial_number="")], RANGE_V, DAY)
    assert len(load_sensors(memory)) == 2
    assert [path.name for path in memory.parent.iterdir()] == [memory.name]


@pytest.mark.parametrize("data", [b"", b"{", b'{"format": "other"}', b"\xff" * 10, b"[]"])
def test_a_file_that_is_none_is_one_sentence(tmp_path, data):
    path = tmp_path / "sensors.json"
    path.write_bytes(data)
    with pytest.raises(SessionError, match=r"sensors\.json: wanted what is remembered.*delete"):
        load_sensors(path)


def test_a_folder_that_cannot_be_written_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(SessionError, match="cannot be"):
        remember_sensors(tmp_path / "file" / "sensors.json", [HAMMER], RANGE_V, DAY)
