"""The simulated laboratory in this process, on a clock that runs only while somebody waits.

Board (the device library), controller and operator are those of `hil_sim`; their lines are byte
queues, so a session of ten lab seconds takes a fraction of a second and is the same every time.
"""

import bisect
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from operator import itemgetter

import numpy as np
from support.known_arm import KnownArm, known_truth
from support.virtual_operator import CHANNEL_FD, Channel, VirtualOperator

from armodal.daq.can_listener import SlcanListener
from armodal.daq.surroundings import Surroundings
from armodal.hil_sim.board import Board
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.board_state import BoardFirmware, Converter
from armodal.hil_sim.cell import Cell
from armodal.hil_sim.clock import DeviceClock, LabClock
from armodal.hil_sim.controller import Controller
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.joint_messages import JointMessages
from armodal.hil_sim.ledger import LedgerWriter
from armodal.hil_sim.plant import build_plant
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.generic_can import generic_mapping
from armodal.protocols.board.codec import FrameDecoder
from armodal.protocols.board.messages import decode_samples
from armodal.protocols.board.records import FrameType
from armodal.protocols.errors import DeviceLostError, PortError

STEP_S = 0.004  # of the laboratory, between two looks at what is due
WAIT_S = 0.001
BOARD_FD, CAN_FD = 1001, 1002
HANGS_AFTER_S = 150.0
LINE_HOLDS = 16384  # bytes, as a pseudo-terminal does
# Room for three blocks of 256 samples of four channels: buffers that can overflow.
BLOCK_CAPACITY = 3 * 256 * 12


class HangError(Exception):
    """An acquisition that goes on though its operator has long given up."""


class MemoryLine:
    """Both ends of a serial line: the device's, and the host's, that can be unplugged."""

    def __init__(self, name, fd):
        self.name = name
        self.fd = fd
        self._outgoing = bytearray()
        self.to_host = bytearray()
        self.to_device = bytearray()
        self.generation = 0
        self.plugged = True

    # The device's end

    @property
    def pending(self):
        return len(self._outgoing)

    def read(self):
        data = bytes(self.to_device[:4096])
        del self.to_device[: len(data)]
        return data

    def queue(self, data):
        self._outgoing += data

    def flush(self):
        room = LINE_HOLDS - len(self.to_host)
        self.to_host += self._outgoing[:room]
        del self._outgoing[:room]
        return not self._outgoing

    def unplug(self):
        self.plugged = False
        self.generation += 1
        self._outgoing.clear()
        self.to_host.clear()
        self.to_device.clear()

    def plug(self):
        self.plugged = True

    # The host's end

    def host(self):
        return HostEnd(self)

    def is_readable(self):
        return bool(self.to_host) or not self.plugged


class HostEnd:
    """What the acquisition holds; lost for good once the line was unplugged."""

    def __init__(self, line):
        if not line.plugged:
            raise PortError(f"cannot open port {line.name}: there is no such device")
        self._line = line
        self._generation = line.generation
        self.name = line.name
        self.heard = bytearray()

    def fileno(self):
        return self._line.fd

    def _check(self):
        if self._line.generation != self._generation:
            raise DeviceLostError(f"the device on {self.name} is gone; plug it in, then resume")

    def read(self):
        self._check()
        data = bytes(self._line.to_host)
        self._line.to_host.clear()
        self.heard += data
        return data

    def write(self, data):
        self._check()
        self._line.to_device += data

    def close(self):
        """Nothing is held."""


_start = itemgetter(0)


@dataclass(eq=False)
class Epoch:
    """Samples since one START: what the converter gave, and when."""

    rate_hz: float
    chunks: list = field(default_factory=list)  # (first index, counts, lab time), in their order
    blows: list = field(default_factory=list)
    next_sample: int = 0

    def counts(self, first, n):
        begin = max(bisect.bisect_right(self.chunks, first, key=_start) - 1, 0)
        end = bisect.bisect_left(self.chunks, first + n, key=_start)
        parts = [
            counts[max(first - start, 0) : max(first + n - start, 0)]
            for start, counts, _ in self.chunks[begin:end]
        ]
        return np.concatenate(parts) if parts else np.zeros((0, 4), np.int32)

    def lab_s(self, sample):
        """Lab time of a sample, to about a step of the laboratory."""
        at = bisect.bisect_right(self.chunks, sample, key=_start) - 1
        start, counts, end_s = self.chunks[max(at, 0)]
        return end_s - (start + len(counts) - sample) / self.rate_hz


class VirtualLab:
    """Everything of a session that is not the acquisition itself.

    `step_s` is lab time between two looks at what is due. Sampling, faults and triggers keep to the
    sample whatever it is.
    """

    def __init__(
        self, plan, directory, *, seed, faults, at_blows=(), block_capacity=BLOCK_CAPACITY,
        calibrated=True, step_s=STEP_S,
    ):  # fmt: skip
        self.step_s = step_s
        self.plan = plan
        self.behind_s = 0.0  # by which the computer slept while the laboratory went on
        self.wall_s = 1000.0
        self.rng = np.random.default_rng(seed)
        self.epochs = []
        self.joints = []  # (lab time, true joint angles), where they change
        clock = LabClock(monotonic=lambda: self.wall_s)
        self.lab_clock = clock
        self.faults = FaultSet(faults)
        truth = known_truth()
        posture = plan.postures[0].joints_rad
        self.cell = Cell(self._make_source, joints_rad=posture, point="1")
        self.ledger = LedgerWriter(
            directory / "ledger.jsonl", build_plant(truth), seed=seed, time_scale=1.0
        )
        self.dictionary = replace(board_dictionary(truth), block_capacity=block_capacity)
        if not calibrated:
            channels = tuple(
                replace(channel, calibration_date="", serial_number="", teds=b"")
                for channel in self.dictionary.channels
            )
            self.dictionary = replace(self.dictionary, channels=channels)
        self.firmware = BoardFirmware(
            self.dictionary,
            session=int(self.rng.integers(1, 1 << 32)),
            clock=DeviceClock(
                lab=clock, boot_s=clock.now_s(), error_ppm=37.0, offset_ticks=60_000_000
            ),
            converter=Converter(
                start=self.cell.start_sampling, stop=self.cell.stop_sampling, read=self.cell.read
            ),
        )
        self.board_line, self.can_line = MemoryLine("board", BOARD_FD), MemoryLine("can", CAN_FD)
        streams = partial(stream, seed)
        self.board = Board(self.firmware, self.board_line, faults=self.faults, streams=streams)
        self._record_samples()
        joints = [link.joint for link in truth.links]
        self.controller = Controller(
            self.cell,
            self.can_line,
            messages=JointMessages(generic_mapping(joints), joints),
            clock=clock,
            faults=self.faults,
            streams=streams,
        )
        self.channel = Channel()
        self.operator = VirtualOperator(self)
        self.ends = []
        self.at_blows = at_blows  # (number of the blow, fault, samples after it, how many)
        self.n_blows = 0

    def close(self):
        self.ledger.close()

    # What the acquisition is given

    def surroundings(self):
        return Surroundings(
            clock=VirtualClock(self),
            open_board=lambda _settings: self._opened(self.board_line),
            open_can=self._open_can,
            make_outbox=lambda _channel: self.operator,
        )

    def _opened(self, line):
        end = line.host()
        self.ends.append(end)
        return end

    def _open_can(self, _settings, bitrate):
        return SlcanListener(self.can_line.host(), bitrate, VirtualClock(self))

    # What is due

    def advance(self, seconds):
        until_s = self.wall_s + seconds
        while self.wall_s < until_s:
            self.wall_s = min(self.wall_s + self.step_s, until_s)
            self.step()
        if self.wall_s > self.operator.begun_s + HANGS_AFTER_S:
            raise HangError(f"still running at {self.wall_s - 1000.0:.0f} s of the laboratory")

    def step(self):
        self.board.step()
        self.controller.step()
        joints_rad = self.controller.joints_rad
        if not self.joints or not np.array_equal(self.joints[-1][1], joints_rad):
            self.joints.append((self.wall_s, np.array(joints_rad)))
        self.operator.step()

    def true_joints(self, begin_s, end_s):
        """All postures the arm truly stood in between two lab times, (n, n_joints)."""
        times = [at for at, _ in self.joints]
        first = max(bisect.bisect_right(times, begin_s) - 1, 0)
        return np.array([q for at, q in self.joints[first:] if at <= end_s])

    def _make_source(self, rate_hz):
        self.epochs.append(Epoch(rate_hz=float(rate_hz)))
        return KnownArm(len(self.epochs))

    def _record_samples(self):
        spoil, lose = self.firmware.spoil, self.firmware.lose_samples

        def recorded(counts):
            counts = spoil(counts)
            epoch = self.epochs[-1]
            epoch.chunks.append((epoch.next_sample, counts.copy(), self.wall_s))
            epoch.next_sample += len(counts)
            return counts

        def lost(count):
            if self.firmware.running:
                self.epochs[-1].next_sample += count
            lose(count)

        self.firmware.spoil = recorded
        self.firmware.lose_samples = lost


class VirtualClock:
    """Lab seconds that pass while somebody waits."""

    def __init__(self, lab):
        self._lab = lab

    def now_s(self):
        return self._lab.wall_s - self._lab.behind_s

    def sleep(self, lab_s):
        if lab_s > 0.0:
            self._lab.advance(lab_s)

    def wall_s(self, lab_s):
        return lab_s

    def wait(self, descriptors, wall_s):
        until_s = self._lab.wall_s + max(wall_s, 0.0)
        while True:
            ready = [fd for fd in descriptors if self._is_ready(fd)]
            if ready or self._lab.wall_s >= until_s:
                return ready
            self._lab.advance(min(WAIT_S, until_s - self._lab.wall_s))

    def _is_ready(self, fd):
        if fd == CHANNEL_FD:
            return self._lab.channel.poll(0)
        line = self._lab.board_line if fd == BOARD_FD else self._lab.can_line
        return line.is_readable()


def heard_stream(end, session):
    """The preview that came to the host's end in order, as long as the board was the same one."""
    decoder, heard, last, described = FrameDecoder(), [], -1, None
    frames = decoder.feed(bytes(end.heard))
    for frame in frames:
        if frame.header.session != session or frame.header.sequence <= last:
            continue
        described = described or frame.header.dictionary_hash
        if frame.header.dictionary_hash != described:
            break
        last = frame.header.sequence
        if frame.header.type is FrameType.STREAM:
            with suppress(ValueError):
                heard.append(decode_samples(frame))
    return heard
