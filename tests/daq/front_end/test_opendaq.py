"""A device of openDAQ as a board: its own reference device, in process and over the network.

Its counter waveform rises by a sample's time with every sample: what comes can be told apart.
"""

import os
import signal
import subprocess
import sys
from contextlib import closing
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from support.at_the_end import at_the_end

from armodal.daq.clock import SystemClock
from armodal.daq.front_end import open_front_end, open_source
from armodal.daq.front_end.drivers.opendaq import OpenDaqDevice
from armodal.daq.front_end.timing import SampleTimes
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError
from armodal.protocols.front_end import front_end_from_text

TEXT = """
format = "armodal-front-end-1"
device = "opendaq"
source = "{source}"
range_v = 10.0
[[channels]]
name = "hammer"
quantity = "force"
input = "AI0"
sensitivity_mv = 2.0
[[channels]]
name = "acc_z"
quantity = "acceleration"
input = "AI1"
sensitivity_mv = -10.0
"""
RATE_HZ = Fraction(25_000)  # 40 ticks of a microsecond
COUNTER = 3  # of the reference device's waveforms
PLAYER = Path(__file__).resolve().parents[2] / "support" / "opendaq_server.py"
SERVER = """
import opendaq, sys, time
instance = opendaq.Instance()
device = instance.add_device("daqref://device0")
for channel in device.channels_recursive:
    channel.set_property_value("Waveform", 3)
server = instance.add_server("OpenDAQNativeStreaming", None)
print("ready", flush=True)
time.sleep(60)
"""


def front_end(source="daqref://device0", text=TEXT):
    return front_end_from_text(text.format(source=source), name="ref", origin="file ref.toml")


@pytest.fixture
def opendaq():
    return pytest.importorskip("opendaq")


@pytest.fixture
def device(opendaq):
    with closing(open_source(front_end())) as source:
        for channel in source._device.channels_recursive:  # noqa: SLF001 - as its own program would
            channel.set_property_value("Waveform", COUNTER)
        yield source


def read_for(source, seconds):
    """Read as an acquisition does, for so long."""
    clock, chunks = SystemClock(), []
    end_s = clock.now_s() + seconds
    while clock.now_s() < end_s:
        clock.sleep(0.012)
        chunks += source.read(clock.now_s())
    return chunks


def test_samples_come_one_after_another(device):
    assert device.rate_refusal(RATE_HZ) == ""
    device.start(RATE_HZ, SystemClock().now_s())
    chunks = read_for(device, 0.5)
    counts = np.concatenate([chunk.counts for chunk in chunks])
    assert len(counts) > 0.3 * RATE_HZ
    assert [chunk.lost for chunk in chunks] == [0] * len(chunks)
    # The counter rises by 40 us a sample, in V of 10: by 33.6 counts. A count is rounding.
    steps = np.diff(counts[:, 0])
    np.testing.assert_allclose(steps, 40e-6 / 10.0 * 2**23, atol=1.0)
    np.testing.assert_array_equal(counts[:, 0], counts[:, 1])


def test_a_rate_that_is_not_exact_is_told(device):
    assert device.rate_refusal(Fraction(25_600)) == "daqref://device0 makes 25641.0256 Hz instead"


def test_what_the_device_s_ticks_leave_out_is_lost_and_no_more():
    source = OpenDaqDevice.__new__(OpenDaqDevice)
    source.name, source._delta, source._next_tick = "ref", 40, None  # noqa: SLF001
    times = SampleTimes("ref", 25_000.0, 0.0)
    counts = np.arange(8, dtype=np.int32).reshape(4, 2)
    cut = source._chunks  # noqa: SLF001
    (first,) = cut(counts, 1000 + 40 * np.arange(4), times, 1.0)
    assert (first.lost, len(first.counts)) == (0, 4)
    # 5 samples left out before, 2 within.
    parts = cut(counts, 1000 + 40 * np.array([9, 10, 13, 14]), times, 1.1)
    assert [(part.lost, part.counts.tolist()) for part in parts] == [
        (5, counts[:2].tolist()),
        (2, counts[2:].tolist()),
    ]
    with pytest.raises(DeviceLostError, match="jumps by other than whole samples"):
        cut(counts, 5000 + 40 * np.arange(4) + 7, times, 1.2)


def test_a_board_is_made_of_it(opendaq, tmp_path, run_link):
    path = tmp_path / "ref.toml"
    path.write_text(TEXT.format(source="daqref://device0"))
    clock = SystemClock()
    with closing(open_front_end(path, clock)) as port:
        link, found = run_link(port, RATE_HZ)
        assert found.dictionary.board_id == "opendaq:ref"
        link.stop()


@pytest.mark.parametrize(
    ("change", "to", "words"),
    [
        ("daqref://device0", "daqref://device7", "no device of openDAQ answers at 'daqref://devi"),
        ('input = "AI1"', 'input = "AI9"', "has no signal 'AI9', wanted one; it has AI0, AI1"),
        (
            "sensitivity_mv = 2.0",
            "full_scale = 2.0",
            "signal AI0 is in V: wanted N with full_scale",
        ),
    ],
)
def test_what_is_not_there_is_told(opendaq, change, to, words):
    with pytest.raises(FrontEndError, match=words):
        open_source(
            front_end(text=TEXT.replace("{source}", "daqref://device0").replace(change, to))
        )


def test_a_missing_package_is_told_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "opendaq", None)
    with pytest.raises(MissingPackageError, match=r"armodal\[opendaq\]"):
        open_source(front_end())


def test_over_the_network_until_the_device_is_killed(opendaq):
    with (
        subprocess.Popen(
            [sys.executable, "-c", SERVER], stdout=subprocess.PIPE, text=True
        ) as server,
        at_the_end(f"kill -9 {server.pid} 2> /dev/null"),
    ):
        assert server.stdout.readline() == "ready\n"
        with closing(open_source(front_end("daq.ns://127.0.0.1"))) as source:
            made = source._made_hz(source._signals[0])  # noqa: SLF001
            assert source.rate_refusal(made) == ""
            source.start(made, SystemClock().now_s())
            chunks = read_for(source, 1.0)
            counts = np.concatenate([chunk.counts for chunk in chunks])
            assert len(counts) > 0.5 * made
            assert sum(chunk.lost for chunk in chunks) == 0
            os.kill(server.pid, signal.SIGKILL)
            with pytest.raises(DeviceLostError, match="sample clock does not advance"):
                read_for(source, 3.0)


def test_signals_of_ours_come_as_they_are_and_what_is_left_out_is_told(opendaq, tmp_path):
    """Each value is its sample's number; the device leaves 777 samples out."""
    rate_hz, gap = 5_000, 777
    numbers = np.arange(200_000)
    np.save(tmp_path / "volts.npy", np.stack([numbers, -numbers], axis=1) / 2**23 * 10.0)
    command = [PLAYER, tmp_path / "volts.npy", str(rate_hz)]
    with subprocess.Popen(
        [sys.executable, *command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as server:
        try:
            address = f"daq.ns://127.0.0.1:{server.stdout.readline().strip()}"
            with closing(open_source(front_end(address))) as source:
                assert source.rate_refusal(Fraction(rate_hz)) == ""
                source.start(Fraction(rate_hz), SystemClock().now_s())
                chunks = read_for(source, 0.5)
                server.stdin.write(f"{gap}\n")
                server.stdin.flush()
                for _ in range(100):
                    chunks += read_for(source, 0.1)
                    if chunks[-1].counts[0, 0] > chunks[0].counts[0, 0] + 5 * gap:
                        break
        finally:
            server.kill()
    assert [chunk.lost for chunk in chunks if chunk.lost] == [gap]
    counts = np.concatenate([chunk.counts for chunk in chunks])
    steps = np.diff(counts[:, 0])
    assert sorted(set(steps)) == [1, gap + 1]
    assert (steps > 1).sum() == 1
    np.testing.assert_array_equal(counts[:, 1], -counts[:, 0])
