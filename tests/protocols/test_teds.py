from dataclasses import replace
from datetime import date

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.channels import channel
from support.teds_bits import basic, bits, iepe

from armodal.protocols.errors import FrameError
from armodal.protocols.teds import contradictions, decode_teds

DAY = date(2026, 3, 2)
RANGE_V = 5.0
RESOLUTION = 1.5e-4  # of a sensitivity in a data sheet, relative


def sensor(**changes):
    made = channel("acc_z", "acceleration", scale=1e-5)
    fields = {"full_scale": 500.0, "serial_number": "A-54321", "calibration_date": "2026-03-02"}
    return replace(made, **({"teds": iepe(0.01, calibrated=DAY)} | fields | changes))


def test_a_basic_data_sheet_tells_who_the_sensor_is():
    told = decode_teds(bits(*basic()))
    assert (told.manufacturer, told.model, told.version) == (31, 393, "B3")
    assert told.serial_number == 54_321
    assert (told.template, told.sensitivity_v) == (None, None)


@pytest.mark.parametrize("transfer", [False, True])
def test_an_accelerometer_tells_its_sensitivity_and_date(transfer):
    told = decode_teds(iepe(0.0102, calibrated=DAY, transfer=transfer))
    assert (told.template, told.quantity, told.calibrated) == (25, "acceleration", DAY)
    assert told.sensitivity_v == pytest.approx(0.0102, rel=RESOLUTION)
    # What another program reads of a Bruel & Kjaer 4506: 67 steps of 6 % from 0.005 Hz.
    assert told.highpass_hz == pytest.approx(0.24800645070661656, rel=1e-12)


def test_a_hammer_tells_its_sensitivity_and_no_date():
    told = decode_teds(iepe(0.00225, is_force=True))
    assert (told.quantity, told.calibrated) == ("force", None)
    assert told.sensitivity_v == pytest.approx(0.00225, rel=RESOLUTION)


def test_a_sensor_upside_down_has_a_negative_sensitivity():
    assert decode_teds(iepe(0.01, sign=1)).sensitivity_v == pytest.approx(-0.01, rel=RESOLUTION)


def test_a_sensor_that_was_never_calibrated_has_no_date():
    assert decode_teds(iepe(0.01)).calibrated is None


def test_other_templates_and_extended_functionality_are_left_alone():
    for more in ([(0, 2), (27, 8)], [(0, 2), (25, 8), (0, 1), (1, 1)], [(1, 2), (25, 8)]):
        told = decode_teds(bits(*basic(), *more, (0xFFFF, 16), (0xFF, 8)))
        assert (told.serial_number, told.quantity, told.sensitivity_v) == (54_321, None, None)


@given(st.binary(max_size=64))
def test_any_bytes_are_read_or_too_short(data):
    if len(data) < 8:
        with pytest.raises(FrameError, match="wanted a TEDS of 8 bytes or more"):
            decode_teds(data)
    else:
        decode_teds(data)


@given(st.binary(min_size=8, max_size=40), st.integers(8, 40))
def test_a_data_sheet_cut_short_tells_no_other_values(data, size):
    whole, cut = decode_teds(data), decode_teds(data[: max(size, 8)])
    for name in ("sensitivity_v", "highpass_hz", "quantity"):
        assert getattr(cut, name) in {None, getattr(whole, name)}


def test_what_agrees_is_not_mentioned():
    assert contradictions(sensor(), RANGE_V) == []
    assert contradictions(sensor(teds=b""), RANGE_V) == []
    assert contradictions(sensor(serial_number="", calibration_date=""), RANGE_V) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"serial_number": "A-1"}, "acc_z: the sensor says serial number 54321, the board A-1"),
        ({"quantity": "force"}, "the sensor says acceleration, the board force"),
        ({"full_scale": 490.0}, "the sensor says 10 mV per m/s^2, the board 10.2"),
        ({"calibration_date": "2025-03-02"}, "calibrated on 2026-03-02, the board 2025-03-02"),
    ],
)
def test_what_contradicts_is_said(changes, words):
    (said,) = contradictions(sensor(**changes), RANGE_V)
    assert words in said


def test_without_the_range_a_sensitivity_is_not_compared():
    assert contradictions(sensor(full_scale=490.0)) == []


def test_a_data_sheet_of_no_maker_contradicts_nothing():
    nobody = sensor(teds=bits(*basic(maker=0)), serial_number="A-1")
    assert contradictions(nobody, RANGE_V) == []


def test_an_impedance_head_is_two_sensors_of_which_each_has_its_data_sheet():
    sheets = {
        "force": iepe(0.022, is_force=True, serial=900),
        "acceleration": iepe(0.0102, calibrated=DAY, serial=901),
    }
    full_scales = {"force": RANGE_V / 0.022, "acceleration": RANGE_V / 0.0102}
    numbers = {"force": "900", "acceleration": "901"}

    def output(quantity, cable):
        made = channel(f"head_{quantity}", quantity, scale=1e-5)
        return replace(
            made, full_scale=full_scales[quantity], serial_number=numbers[quantity],
            calibration_date="", teds=sheets[cable],
        )  # fmt: skip

    for quantity in sheets:
        assert contradictions(output(quantity, quantity), RANGE_V) == []
    swapped = contradictions(output("force", "acceleration"), RANGE_V)
    assert any("the sensor says acceleration, the board force" in said for said in swapped)
