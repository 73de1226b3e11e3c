import sys
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from support import synthetic_laboratory
from support.host_side import BoardLine, Line, OperatorLine
from support.synthetic_laboratory import KnownSource, truth

from armodal.hil_sim.board import Board
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.board_state import BoardFirmware, Converter
from armodal.hil_sim.cell import Cell
from armodal.hil_sim.clock import DeviceClock, LabClock
from armodal.hil_sim.controller import Controller
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.joint_messages import JointMessages
from armodal.hil_sim.lab import launch
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.generic_can import generic_mapping


class Time:
    """A monotonic clock that moves only when told."""

    def __init__(self):
        self.now_s = 100.0

    def __call__(self):
        return self.now_s


class Bench:
    """Board and controller in this process, on a clock in the test's hand."""

    def __init__(self, faults=()):
        self.time = Time()
        self.clock = LabClock(monotonic=self.time)
        self.faults = FaultSet(faults)
        self.source = None
        self.make_source = KnownSource
        self.cell = Cell(self._make, joints_rad=np.zeros(6), point="1")
        self.device_clock = DeviceClock(
            lab=self.clock, boot_s=self.time(), error_ppm=50.0, offset_ticks=1000
        )
        self.firmware = BoardFirmware(
            board_dictionary(truth()),
            session=0xABCD,
            clock=self.device_clock,
            converter=Converter(
                start=self.cell.start_sampling, stop=self.cell.stop_sampling, read=self.cell.read
            ),
        )
        self.board_port, self.can_port = PtyPort(), PtyPort()
        streams = partial(stream, 1)
        self.board = Board(self.firmware, self.board_port, faults=self.faults, streams=streams)
        joints = [link.joint for link in truth().links]
        self.controller = Controller(
            self.cell,
            self.can_port,
            messages=JointMessages(generic_mapping(joints), joints),
            clock=self.clock,
            faults=self.faults,
            streams=streams,
        )
        self.host = BoardLine(self.board_port.name, self.board.step)
        self.listener = Line(self.can_port.name, self.controller.step)

    def _make(self, rate_hz):
        self.source = self.make_source()
        return self.source

    def close(self):
        for end in (self.host, self.listener, self.board_port, self.can_port):
            end.close()


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


@contextmanager
def _starting(folder):
    """Start laboratories with the known source as processes; all are ended with the context."""
    started, lines = [], []

    class Running:
        def __init__(self, laboratory):
            self.laboratory = laboratory

        def open(self, kind, path):
            lines.append(kind(path))
            return lines[-1]

        def board(self):
            return self.open(BoardLine, self.laboratory.board)

        def can(self):
            return self.open(Line, self.laboratory.can)

        def operator(self):
            return self.open(OperatorLine, self.laboratory.operator)

    def start(*, time_scale=16.0, faults=()):
        script = Path(synthetic_laboratory.__file__)
        command = [sys.executable, str(script), "--time-scale", str(time_scale), "--seed", "3"]
        command += ["--directory", str(folder / "lab"), "--watch-stdin"]
        for fault in faults:
            command += ["--fault", fault]
        running = Running(launch(command))
        started.append(running.laboratory)
        return running

    yield start
    for line in lines:
        line.close()
    for laboratory in started:
        laboratory.close()


@pytest.fixture
def start_known_laboratory(tmp_path, real_time):
    """Start the laboratory with the known source as a process."""
    with _starting(tmp_path) as start:
        yield start


@pytest.fixture(scope="module")
def known_laboratory(tmp_path_factory, real_time):
    """One at eight times the speed, for what leaves it as it was."""
    with _starting(tmp_path_factory.mktemp("shared")) as start:
        yield start(time_scale=8.0)


@pytest.fixture(scope="module")
def shared_bench():
    """A bench for properties: what one example leaves behind, the next must bear."""
    made = Bench()
    yield made
    made.close()
