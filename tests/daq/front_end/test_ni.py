"""A module of NI as a board, against a fake of nidaqmx: volts to counts, rates, codes."""

import sys
from contextlib import closing
from fractions import Fraction

import numpy as np
import pytest
from support.fake_ni import FakeNi

from armodal.daq.front_end import open_front_end, open_source
from armodal.protocols.board.samples import COUNT_MAX
from armodal.protocols.errors import (
    BoardRefusedError,
    DeviceLostError,
    FrontEndError,
    MissingPackageError,
)
from armodal.protocols.front_end import front_end_from_text

TEXT = """
format = "armodal-front-end-1"
device = "ni"
source = "cDAQ1Mod1"
range_v = 5.0
[[channels]]
name = "hammer"
quantity = "force"
input = "ai0"
sensitivity_mv = 2.25
iepe_ma = 2.0
[[channels]]
name = "acc_z"
quantity = "acceleration"
input = "ai1"
sensitivity_mv = -10.2
"""
RATE = Fraction(51_200, 31)


@pytest.fixture
def ni(monkeypatch):
    fake = FakeNi()
    for name, module in fake.modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    return fake


def opened():
    return open_source(front_end_from_text(TEXT, name="ni", origin="front-end file ni.toml"))


def test_counts_are_parts_of_the_range(ni, tmp_path, time, run_link, streamed):
    path = tmp_path / "ni.toml"
    path.write_text(TEXT)
    volts = np.random.default_rng(1).uniform(-5.0, 5.0, (640, 2))
    with closing(open_front_end(path, time)) as port:
        link, found = run_link(port, RATE)
        ni.volts = volts
        time.now += 0.5
        came = streamed(link)
    volts = volts[: sum(len(samples.counts) for _, samples in came)]  # whole frames of the preview
    assert len(volts) > 500
    counts = np.concatenate([samples.counts for _, samples in came])
    # A count is the 2^23rd part of 5 V; half a count is rounding.
    np.testing.assert_allclose(counts, volts / 5.0 * (COUNT_MAX + 1), atol=0.51)
    hammer, acc_z = found.dictionary.channels
    np.testing.assert_allclose(
        counts[:, 0] * hammer.scale, volts[:, 0] / 2.25e-3, atol=hammer.full_scale * 3e-7
    )
    np.testing.assert_allclose(
        counts[:, 1] * acc_z.scale, volts[:, 1] / -10.2e-3, atol=acc_z.full_scale * 3e-7
    )
    assert ni.closed


def test_supply_and_range_are_those_of_the_file(ni):
    opened().close()
    (force, hammer), (acceleration, acc_z) = ni.channels
    assert (force, acceleration) == ("cDAQ1Mod1/ai0", "cDAQ1Mod1/ai1")
    assert hammer["current_excit_source"].name == "INTERNAL"
    assert hammer["current_excit_val"] == pytest.approx(2e-3)
    assert hammer["max_val"] == pytest.approx(5.0 / 2.25e-3)
    assert acc_z["current_excit_source"].name == "NONE"
    assert acc_z["sensitivity"] == pytest.approx(10.2 * 9.80665)


def test_data_sheets_of_sensors_are_those_that_the_driver_reads(ni):
    ni.teds["cDAQ1Mod1/ai1"] = [1, 2, 3]
    assert opened().teds == (b"", b"\x01\x02\x03")


def test_a_rate_that_is_not_exact_is_refused_with_the_module_s(ni, tmp_path, time, run_link):
    path = tmp_path / "ni.toml"
    path.write_text(TEXT)
    with (
        closing(open_front_end(path, time)) as port,
        pytest.raises(BoardRefusedError, match=r"cDAQ1Mod1 makes 10240 Hz instead"),
    ):
        run_link(port, 10_000)


def test_an_open_sensor_circuit_is_refused(ni):
    source = opened()
    ni.open_inputs = ["cDAQ1Mod1/ai1"]
    with pytest.raises(FrontEndError, match="sensor circuit of cDAQ1Mod1/ai1 is open: check"):
        source.start(RATE, 0.0)
    assert not ni.running


def test_a_short_sensor_circuit_is_refused(ni):
    source = opened()
    ni.short_inputs = ["cDAQ1Mod1/ai0"]
    with pytest.raises(FrontEndError, match=r"circuit of cDAQ1Mod1/ai0 is at fault, .*: check"):
        source.start(RATE, 0.0)
    assert not ni.running


def test_a_module_that_does_not_look_for_open_circuits_measures(ni):
    ni.looks_for_open = False
    opened().start(RATE, 0.0)
    assert ni.running


@pytest.mark.parametrize(
    ("call", "code", "kind", "words"),
    [
        ("add", -200220, FrontEndError, "cDAQ1Mod1: there is no such device; NI MAX, or"),
        ("add", -200170, FrontEndError, "there is no such input; the inputs are called ai0"),
        ("add", -200431, FrontEndError, "this input cannot measure that; it wants IEPE"),
        ("start", -50103, FrontEndError, "another program holds it; close that"),
        ("read", -200279, DeviceLostError, "overwritten before they were read: .*; then resume"),
        ("read", -201003, DeviceLostError, "cannot be reached; check its power and cable"),
        ("start", -200001, FrontEndError, "the driver says code -200001"),
    ],
)
def test_what_the_driver_refuses_is_one_sentence(ni, call, code, kind, words):
    def session():
        source = opened()
        source.start(RATE, 0.0)
        source.read(0.1)

    ni.fails = {call: code}
    with pytest.raises(kind, match=words) as raised:
        session()
    assert "NI says" not in str(raised.value)


def test_a_module_whose_clock_stands_still_is_lost(ni):
    source = opened()
    source.start(RATE, 0.0)
    with pytest.raises(DeviceLostError, match="its sample clock does not advance"):
        source.read(1.1)


def test_a_missing_driver_is_told_with_where_to_get_it(ni):
    ni.installed = False
    with pytest.raises(MissingPackageError, match=r"wanted the driver NI-DAQmx.*get it from NI"):
        opened()


def test_a_missing_package_is_told_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "nidaqmx", None)
    with pytest.raises(MissingPackageError, match=r"armodal\[ni\]"):
        opened()
