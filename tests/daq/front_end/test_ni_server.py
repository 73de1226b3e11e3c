"""A module of NI at a server: the package nidaqmx itself, by gRPC, with a server of ours.

Killed or silent in the midst of a session, what was accepted is in the journal.
"""

import os
import platform
import signal
import socket
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from support.acquisition_run import Run
from support.teds_bits import iepe

from armodal.daq.clock import SystemClock
from armodal.daq.commands import Ready
from armodal.daq.front_end import open_front_end, open_source
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.samples import COUNT_MAX
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError, PortError
from armodal.protocols.front_end import front_end_from_text
from armodal.protocols.session.journal import load_journal

pytest.importorskip("nidaqmx")
pytest.importorskip("grpc")
from support import ni_server

TEXT = """
format = "armodal-front-end-1"
device = "ni"
source = "cDAQ1Mod1"
server = "{server}"
range_v = 5.0
[[channels]]
name = "hammer"
quantity = "force"
input = "ai0"
sensitivity_mv = 6.25
iepe_ma = 2.0
[[channels]]
name = "acc_x"
quantity = "acceleration"
input = "ai1"
sensitivity_mv = 62.5
[[channels]]
name = "acc_y"
quantity = "acceleration"
input = "ai3"
sensitivity_mv = 62.5
[[channels]]
name = "acc_z"
quantity = "acceleration"
input = "ai2"
sensitivity_mv = -62.5
"""
RATE = Fraction(51_200, 4)
COLUMNS = [0, 1, 3, 2]  # of the server's volts


@pytest.fixture
def module():
    return ni_server.Module(np.random.default_rng(1).uniform(-5.0, 5.0, (5000, 4)))


@pytest.fixture
def address(module):
    server, port = ni_server.serve(module)
    yield f"127.0.0.1:{port}"
    server.stop(None)


def front_end(address, text=TEXT):
    return front_end_from_text(text.format(server=address), name="ni", origin="file ni.toml")


def read_for(source, seconds):
    clock, chunks = SystemClock(), []
    end_s = clock.now_s() + seconds
    while clock.now_s() < end_s:
        clock.sleep(0.012)
        chunks += source.read(clock.now_s())
    return chunks


def test_every_sample_comes_once_and_in_order(module, address):
    with closing(open_source(front_end(address))) as source:
        assert source.rate_refusal(RATE) == ""
        source.start(RATE, SystemClock().now_s())
        counts = np.concatenate([chunk.counts for chunk in read_for(source, 0.6)])
        source.stop()
    assert len(counts) > len(module.volts)  # round once
    rows = np.arange(len(counts)) % len(module.volts)
    # Half a count is rounding; the driver's physical values cost less than another tenth.
    wanted = module.volts[np.ix_(rows, COLUMNS)] / 5.0 * (COUNT_MAX + 1)
    np.testing.assert_allclose(counts, wanted, atol=0.6)


def test_a_rate_that_the_module_does_not_make_is_told_with_its_own(address):
    with closing(open_source(front_end(address))) as source:
        assert source.rate_refusal(Fraction(10_000)) == "cDAQ1Mod1 makes 10240 Hz instead"


@pytest.mark.parametrize(
    ("change", "to", "words"),
    [
        ("cDAQ1Mod1", "cDAQ1Mod7", "cDAQ1Mod7: there is no such device"),
        ('"ai3"', '"ai9"', "there is no such input; the inputs are called ai0"),
    ],
)
def test_what_is_not_there_is_one_sentence(address, change, to, words):
    with pytest.raises(FrontEndError, match=words) as raised:
        open_source(front_end(address, TEXT.replace(change, to)))
    assert "NI says" not in str(raised.value)


@pytest.mark.parametrize(
    ("kind", "words"), [("open_inputs", "is open"), ("short_inputs", "is at fault, .* a short")]
)
def test_an_open_or_short_sensor_circuit_is_refused(module, address, kind, words):
    setattr(module, kind, ["cDAQ1Mod1/ai1"])
    with closing(open_source(front_end(address))) as source:
        with pytest.raises(FrontEndError, match=f"circuit of cDAQ1Mod1/ai1 {words}: check sensor"):
            source.start(RATE, 0.0)
        (task,) = module.tasks.values()
        assert task.started_s is None


def test_samples_that_were_overwritten_end_the_session(module, address):
    with closing(open_source(front_end(address))) as source:
        source.start(RATE, SystemClock().now_s())
        (task,) = module.tasks.values()
        task.started_s -= 20.0  # nobody has read for so long
        with pytest.raises(DeviceLostError, match=r"were overwritten .* then resume"):
            read_for(source, 1.0)


def test_a_task_that_a_killed_program_left_does_not_keep_the_module(module, address):
    left = ni_server.Task()
    left.started_s = 0.0
    module.tasks[f"armodal {platform.node()} cDAQ1Mod1"] = left
    with closing(open_source(front_end(address))) as source:
        source.start(RATE, 0.0)
        assert left not in module.tasks.values()
        assert len(module.tasks) == 1
    assert not module.tasks


def test_a_module_that_another_program_of_this_computer_holds_is_refused(address):
    with (
        closing(open_source(front_end(address))),
        pytest.raises(PortError, match="cDAQ1Mod1 is in use by"),
    ):
        open_source(front_end(address))


def test_a_module_that_another_computer_holds_is_refused(module, address):
    other = ni_server.Task()
    other.started_s = 0.0
    module.tasks["armodal elsewhere cDAQ1Mod1"] = other
    with (
        closing(open_source(front_end(address))) as source,
        pytest.raises(FrontEndError, match="another program holds it; close that"),
    ):
        source.start(RATE, 0.0)


def test_a_server_that_is_not_there_is_told():
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        with pytest.raises(FrontEndError, match=f"Device Server answers at 127.0.0.1:{port}"):
            open_source(front_end(f"127.0.0.1:{port}"))


def test_a_missing_package_is_told_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "grpc", None)
    with pytest.raises(MissingPackageError, match=r"grpcio.*armodal\[ni\]"):
        open_source(front_end("127.0.0.1:31763"))


@pytest.fixture
def served(tmp_path):
    """A server in a process of its own; its address is `.address`."""
    started = []

    def start(volts):
        np.save(tmp_path / "volts.npy", volts)
        command = [sys.executable, str(Path(ni_server.__file__)), str(tmp_path / "volts.npy")]
        server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        started.append(server)
        return server, f"127.0.0.1:{server.stdout.readline().strip()}"

    yield start
    for server in started:
        server.kill()
        server.wait()
        server.stdin.close()
        server.stdout.close()


def test_a_server_that_falls_silent_is_lost_and_not_waited_for(served):
    server, address = served(np.zeros((100, 4)))
    with closing(open_source(front_end(address))) as source:
        source.start(RATE, SystemClock().now_s())
        os.kill(server.pid, signal.SIGSTOP)
        began = time.monotonic()
        with pytest.raises(DeviceLostError, match=r"DEADLINE_EXCEEDED\); check it and the network"):
            read_for(source, 10.0)
        assert time.monotonic() - began < 5.0  # one call's two seconds, and a loaded machine
        os.kill(server.pid, signal.SIGKILL)


def test_a_session_is_captured_and_what_was_accepted_outlives_the_server(
    lab, fakes, tmp_path, served
):
    lab.board.unplug()
    record = fakes["record"](pretrigger=64)
    quiet = np.zeros((1600 - len(record), 4))
    physical = np.concatenate([record * [1e-4, 1e-5, 1e-5, 1e-5], quiet])
    volts = physical[:, COLUMNS] * [6.25e-3, 62.5e-3, -62.5e-3, 62.5e-3]
    volts += np.random.default_rng(2).normal(0.0, 1e-4, volts.shape)
    server, address = served(volts)
    path = tmp_path / "ni.toml"
    path.write_text(TEXT.format(server=address))
    run = Run(lab, board_port=str(path), plan=at_rate(lab.plan))
    run.prompt(PromptKind.POINT)
    run.ours.send(Ready())
    hit = run.judged()
    os.kill(server.pid, signal.SIGKILL)
    assert "the NI gRPC Device Server does not do what is asked" in run.failure().message
    run.ours.close()
    assert hit.verdict.accepted
    assert hit.verdict.peak_n == pytest.approx(190.0, abs=20.0)  # half a sample off the top
    (kept,) = load_journal(lab.journal).hits
    np.testing.assert_array_equal(kept.counts, hit.counts)


def at_rate(plan):
    """The plan at a rate that the module makes: 51 200 Hz over 31."""
    sampling = replace(plan.sampling, rate_hz=Fraction(51_200, 31))
    return replace(plan, sampling=sampling)


def test_data_sheets_of_sensors_are_read(module, address, tmp_path, run_link):
    """A sensor without one, as most, leaves its channel without."""
    module.teds["cDAQ1Mod1/ai0"] = sheet = iepe(0.00625, is_force=True, serial=7)
    path = tmp_path / "ni.toml"
    path.write_text(TEXT.format(server=address))
    with closing(open_front_end(path, SystemClock())) as port:
        _, found = run_link(port, RATE)
    assert [channel.teds for channel in found.dictionary.channels] == [sheet, b"", b"", b""]


def test_a_data_sheet_that_contradicts_the_file_is_refused(lab, module, address, tmp_path):
    lab.board.unplug()
    module.teds["cDAQ1Mod1/ai0"] = iepe(0.00225, is_force=True, serial=7)
    path = tmp_path / "ni.toml"
    path.write_text(TEXT.format(server=address))
    run = Run(lab, board_port=str(path), plan=at_rate(lab.plan))
    message = run.failure().message
    run.ours.close()
    assert "hammer: the sensor says 2.25 mV per N, the board 6.25" in message
    assert not lab.journal.exists()


def test_the_server_is_of_an_ni_module_alone():
    text = TEXT.replace('"ni"', '"opendaq"', 1).format(server="127.0.0.1:31763")
    with pytest.raises(FrontEndError, match="server"):
        front_end_from_text(text, name="x", origin="x")


def test_an_address_without_a_port_is_refused():
    with pytest.raises(FrontEndError, match="server"):
        front_end("192.168.1.20")


def test_a_front_end_file_becomes_a_board(address, tmp_path, run_link):
    path = tmp_path / "ni.toml"
    path.write_text(TEXT.format(server=address))
    with closing(open_front_end(path, SystemClock())) as port:
        link, found = run_link(port, RATE)
        assert found.dictionary.board_id == "ni:ni"
        assert found.dictionary.firmware.startswith("nidaqmx ")
        link.stop()
