"""A board and a controller small enough to be read at a glance, behind pseudo-terminals."""

from __future__ import annotations

import os
import pty
import select
import tempfile
import threading
import time
import tty
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from support.channels import channel

from armodal.protocols.arm.records import Arm
from armodal.protocols.board.codec import (
    FrameDecoder,
    encode_frame,
)
from armodal.protocols.board.messages import (
    decode_payload,
    dictionary_hash,
    encode_answer,
    encode_dictionary,
    encode_payload,
    encode_reply,
    encode_samples,
    hello_fragments,
)
from armodal.protocols.board.records import (
    MESSAGES,
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Configuration,
    Frame,
    FrameType,
    Header,
    Release,
    ReplyCode,
    Resend,
    Samples,
)
from armodal.protocols.can_database import CanEncoder
from armodal.protocols.slcan import encode_slcan

TICK_HZ = 1_000_000
RATE_HZ = 1652.0


def dictionary(board_id: str = "fake") -> BoardDictionary:
    return BoardDictionary(
        board_id=board_id,
        firmware="1",
        link_bytes_per_s=10_000_000,
        block_capacity=1_000_000,
        tick_hz=TICK_HZ,
        filter_group_delay_samples=0.0,
        channels=(
            channel("hammer", "force", 1e-4),
            channel("acc_x", "acceleration", 1e-5),
            channel("acc_y", "acceleration", 1e-5),
            channel("acc_z", "acceleration", 1e-5),
        ),
    )


class Line:
    """Our end of a pseudo-terminal, served by a thread until closed.

    Its name is a link of its own, gone with the line: the system gives a terminal's number to the
    next that asks, perhaps in another process, and a host that opens the line again must not
    reach that one.
    """

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self._folder = tempfile.TemporaryDirectory(prefix="line-")
        self.name = str(Path(self._folder.name) / "line")
        Path(self.name).symlink_to(os.ttyname(slave))
        os.set_blocking(self.master, False)  # a host that reads nothing must not hold us for ever
        self._slave = slave  # kept open, so that the master never reads EIO
        self.lock = threading.RLock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def start(self) -> Line:
        self._thread.start()
        return self

    def write(self, data: bytes) -> None:
        with self.lock:
            while data and not self._stop.is_set():
                if select.select([], [self.master], [], 0.01)[1]:
                    with suppress(BlockingIOError):
                        data = data[os.write(self.master, data) :]

    def unplug(self) -> None:
        """Hang up, once: the descriptors' numbers may be others' when it is called again."""
        if self._stop.is_set():
            return
        self._stop.set()
        self._thread.join(5.0)
        self._folder.cleanup()
        for fd in (self._slave, self.master):
            os.close(fd)

    def received(self, data: bytes) -> None:
        """Called with what the other end wrote; a bare line drops it."""

    def tick(self) -> None:
        """Called a few hundred times a second."""

    def _serve(self) -> None:
        while not self._stop.is_set():
            if select.select([self.master], [], [], 0.002)[0]:
                self.received(os.read(self.master, 4096))
            self.tick()


@dataclass
class Held:
    info: BlockInfo
    counts: np.ndarray


class FakeBoard(Line):
    """Answers as the protocol says, and sends the blocks it is given.

    A command that is answered with a record gets that of `tells`; without one it is unknown.
    """

    def __init__(self) -> None:
        super().__init__()
        self.dictionary_bytes = encode_dictionary(dictionary())
        self.session = 0x5EED1234
        self.configuration: Configuration | None = None
        self.state = BoardState.IDLE
        self.blocks: dict[int, Held] = {}
        self.released: list[int] = []
        self.resends: list[tuple[int, int, int]] = []
        self.drop: Callable[[FrameType, int], bool] = lambda kind, first: False
        self.mute = False
        self.tells: dict[FrameType, object] = {}
        self._decoder = FrameDecoder()
        self.sequence = 0
        self._last_block = 0
        self._started_s = 0.0
        self.scale = 1.0
        self.struck_s = 0.0

    def now_s(self) -> float:
        return time.monotonic() * self.scale

    def send(self, kind: FrameType, payload: bytes, *, tag: int = 0, first: int = 0) -> None:
        with self.lock:
            header = Header(
                type=kind,
                session=self.session,
                sequence=self.sequence,
                dictionary_hash=dictionary_hash(self.dictionary_bytes),
                tag=tag,
                first_sample=first,
                ticks=int(self.now_s() * TICK_HZ),
            )
            self.sequence += 1
            if not self.drop(kind, first):
                self.write(encode_frame(header, payload))

    def hit(self, counts: np.ndarray) -> int:
        """Send a block that has just ended."""
        with self.lock:
            assert self.configuration is not None
            self._last_block += 1
            n, lead = len(counts), self.configuration.pretrigger
            now_s = self.now_s()
            trigger_s = now_s - (n - lead) / RATE_HZ
            self.struck_s = trigger_s
            trigger = int((trigger_s - self._started_s) * RATE_HZ) + 10_000
            info = BlockInfo(
                block_id=self._last_block,
                first_sample=trigger - lead,
                length=n,
                trigger_sample=trigger,
                trigger_ticks=int(trigger_s * TICK_HZ),
            )
            self.blocks[info.block_id] = Held(info=info, counts=counts)
            self.send_block(info.block_id, 0, n)
            return info.block_id

    def send_block(self, block_id: int, start: int, count: int) -> None:
        held = self.blocks[block_id]
        self.send(FrameType.BLOCK_READY, encode_payload(held.info))
        for at in range(start, start + count, 64):
            first = held.info.first_sample + at
            part = held.counts[at : min(at + 64, start + count)]
            samples = Samples(first_sample=first, counts=part, block_id=block_id)
            self.send(FrameType.BLOCK_DATA, encode_samples(samples), first=first)

    def received(self, data: bytes) -> None:
        for frame in self._decoder.feed(data):
            if not self.mute:
                with self.lock:
                    self.answer(frame)

    def answer(self, frame: Frame) -> None:
        kind, tag = frame.header.type, frame.header.tag
        reply = encode_reply(ReplyCode.OK)
        if kind is FrameType.HELLO:
            for fragment in hello_fragments(self.dictionary_bytes):
                self.send(FrameType.HELLO_REPLY, fragment, tag=tag)
            return
        if kind is FrameType.CONFIGURE:
            self.configuration = decode_payload(Configuration, frame.payload)
            self.state = BoardState.CONFIGURED
        elif kind is FrameType.START:
            self.state = BoardState.RUNNING
            self._started_s = self.now_s()
        elif kind is FrameType.STOP and self.state is BoardState.RUNNING:
            self.state = BoardState.CONFIGURED
        elif kind is FrameType.STATUS:
            reply = encode_answer(self.tells.get(kind) or self.status())
        elif MESSAGES[FrameType(kind | 0x80)].record is not None:
            told = self.tells.get(kind)
            reply = encode_answer(told) if told else encode_reply(ReplyCode.UNKNOWN_COMMAND)
        elif kind is FrameType.RELEASE:
            block_id = decode_payload(Release, frame.payload).block_id
            self.released.append(block_id)
            self.blocks.pop(block_id, None)
        self.send(FrameType(kind | 0x80), reply, tag=tag)
        if kind is FrameType.RESEND:
            asked = decode_payload(Resend, frame.payload)
            wanted = (asked.block_id, asked.first, asked.count)
            self.resends.append(wanted)
            if wanted[0] in self.blocks:
                self.send_block(*wanted)

    def status(self) -> BoardStatus:
        return BoardStatus(
            state=self.state,
            next_sequence=self.sequence + 1,
            next_sample=0,
            buffered_blocks=len(self.blocks),
            oldest_block=min(self.blocks, default=0),
            stream_samples_dropped=0,
            triggers_missed=0,
            adc_overruns=0,
        )


class FakeController(Line):
    """An slcan adapter on the bus of a controller that sends its cycle 125 times a second."""

    def __init__(self, arm: Arm, joints_rad: np.ndarray) -> None:
        super().__init__()
        assert arm.can is not None
        self._encoder = CanEncoder(arm.can)
        self._names = [joint.name for joint in arm.joints]
        self.joints_rad = joints_rad
        self.drive_state = arm.can.drive_state.held_values[0] if arm.can.drive_state else 0
        self.silent = False
        self.scale = 1.0
        self.refuse = b""
        self.commands: list[bytes] = []
        self._counter = 0
        self._next_s = time.monotonic()

    def received(self, data: bytes) -> None:
        for command in data.split(b"\r")[:-1]:
            self.commands.append(command)
            self.write(b"\x07" if self.refuse and command.startswith(self.refuse) else b"\r")

    def tick(self) -> None:
        now_s = time.monotonic()
        if b"L" not in self.commands or self.silent:
            self._next_s = now_s
        # A controller keeps its rate however late this thread wakes.
        while self._next_s < now_s:
            self._next_s += 0.008 / self.scale
            self._tell()

    def _tell(self) -> None:
        self._counter += 1
        angles = dict(zip(self._names, self.joints_rad.tolist(), strict=True))
        frames = self._encoder.encode(angles, drive_state=self.drive_state, counter=self._counter)
        self.write(b"".join(encode_slcan(f.can_id, f.data) for f in frames))
