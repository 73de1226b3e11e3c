"""A board that streams as fast as the papers' board can, made of frames prepared beforehand.

Run as a process of its own by `bench_acquisition.py`: serves a board and a controller on two
pseudo-terminals, prints their names, and at the end one JSON line with what it sent.
"""

from __future__ import annotations

import json
import os
import pty
import select
import struct
import sys
import time
import tty
import zlib
from contextlib import suppress

import numpy as np
from cobs import cobs

from armodal.daq.process import ask_for_priority
from armodal.protocols.arm.files import load_arm
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
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Channel,
    Configuration,
    FrameType,
    Header,
    IepeState,
    Release,
    ReplyCode,
    Samples,
)
from armodal.protocols.can_database import CanEncoder
from armodal.protocols.slcan import encode_slcan

RATE_HZ = 51200
TICK_HZ = 1_000_000
SESSION = 0x0BADCAFE
HEADER = struct.Struct("<BBHIIHHQQ")
CRC = struct.Struct("<I")
JOINTS = np.radians([-25.0, 90.0, 0.0, 0.0, 90.0, 0.0])
HIT_EVERY_S = 2.0
LATE_S = 0.1  # between two turns of a board that takes one every 2 ms: it was kept from running


def terminal() -> tuple[int, int, str]:
    master, slave = pty.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    return master, slave, os.ttyname(slave)


def channel(name: str, quantity: str, scale: float) -> Channel:
    return Channel(
        name=name,
        quantity=quantity,
        unit="N" if quantity == "force" else "m/s^2",
        scale=scale,
        full_scale=scale * 8388607,
        iepe=IepeState.OK,
        highpass_hz=0.0,
        serial_number="",
        calibration_date="",
        teds=b"",
    )


DICTIONARY = encode_dictionary(
    BoardDictionary(
        board_id="feeder",
        firmware="1",
        link_bytes_per_s=4_000_000,
        block_capacity=2_000_000,
        tick_hz=TICK_HZ,
        filter_group_delay_samples=0.0,
        channels=(
            channel("hammer", "force", 1e-4),
            channel("acc_x", "acceleration", 1e-5),
            channel("acc_y", "acceleration", 1e-5),
            channel("acc_z", "acceleration", 1e-5),
        ),
    )
)
HASH = dictionary_hash(DICTIONARY)


class Feeder:
    """One board and one controller, paced by time."""

    def __init__(self) -> None:
        self.board, self._slave, board_name = terminal()
        self.bus, self._bus_slave, bus_name = terminal()
        print(json.dumps({"board": board_name, "can": bus_name}), flush=True)
        rng = np.random.default_rng(1)
        noise = rng.integers(-3000, 3000, (64, 4)).astype(np.int32)
        self.payload = encode_samples(Samples(first_sample=0, counts=noise))
        arm = load_arm("rv4frl")
        self.encoder = CanEncoder(arm.can)
        self.names = [joint.name for joint in arm.joints]
        self.decoder = FrameDecoder()
        self.out = bytearray()
        self.sequence = 0
        self.sample = 0
        self.started_s = 0.0
        self.configuration: Configuration | None = None
        self.running = False
        self.block = 0
        self.held = 0
        self.sent = {
            "bytes": 0, "stream_samples": 0, "dropped_samples": 0, "dropped_late": 0, "blocks": 0,
        }  # fmt: skip

    def frame(self, kind: FrameType, payload: bytes, tag: int = 0, first: int = 0) -> bytes:
        ticks = int(time.monotonic() * TICK_HZ)
        header = Header(
            type=kind, session=SESSION, sequence=self.sequence, dictionary_hash=HASH, tag=tag,
            first_sample=first, ticks=ticks,
        )  # fmt: skip
        self.sequence += 1
        return encode_frame(header, payload)

    def stream_frame(self) -> bytes:
        body = (
            HEADER.pack(
                1, FrameType.STREAM, HASH, SESSION, self.sequence, 0, 0, self.sample,
                int(time.monotonic() * TICK_HZ),
            )
            + self.payload
        )  # fmt: skip
        self.sequence += 1
        return b"\0" + cobs.encode(body + CRC.pack(zlib.crc32(body))) + b"\0"

    def answer(self) -> None:
        for frame in self.decoder.feed(os.read(self.board, 4096)):
            kind, tag = frame.header.type, frame.header.tag
            reply = encode_reply(ReplyCode.OK)
            if kind is FrameType.HELLO:
                for fragment in hello_fragments(DICTIONARY):
                    self.out += self.frame(FrameType.HELLO_REPLY, fragment, tag)
                continue
            if kind is FrameType.CONFIGURE:
                self.configuration = decode_payload(Configuration, frame.payload)
            elif kind is FrameType.START:
                self.running, self.started_s, self.sample = True, time.monotonic(), 0
                self.next_hit_s = self.started_s + HIT_EVERY_S
            elif kind is FrameType.STOP:
                self.running = False
            elif kind is FrameType.STATUS:
                reply = encode_answer(
                    BoardStatus(
                        state=BoardState.RUNNING if self.running else BoardState.CONFIGURED,
                        next_sequence=self.sequence + 1,
                        next_sample=self.sample,
                        buffered_blocks=int(self.held > 0),
                        oldest_block=self.held,
                        stream_samples_dropped=self.sent["dropped_samples"],
                        triggers_missed=0,
                        adc_overruns=0,
                    )
                )
            elif (
                kind is FrameType.RELEASE
                and decode_payload(Release, frame.payload).block_id == self.held
            ):
                self.held = 0
            self.out += self.frame(FrameType(kind | 0x80), reply, tag)

    def hit(self, now_s: float) -> None:
        configuration = self.configuration
        assert configuration is not None
        n, lead = configuration.block_length, configuration.pretrigger
        rate_hz = float(configuration.rate_hz)
        t = (np.arange(n) - lead) / rate_hz
        force = np.where((t >= 0) & (t < 3e-3), 200.0 * np.sin(np.pi * (t + 1e-5) / 3e-3), 0.0)
        answer = np.where(t > 0, 5.0 * np.exp(-3 * t) * np.sin(75.0 * t), 0.0)
        counts = np.stack([force * 1e4, answer * 1e5, answer * 1e5, answer * 1e5], axis=1)
        counts = counts.astype(np.int32)
        self.block += 1
        self.held = self.block
        first = int((now_s - self.started_s) * rate_hz) - n
        self.out += self.frame(
            FrameType.BLOCK_READY,
            encode_payload(
                BlockInfo(
                    block_id=self.block,
                    first_sample=first,
                    length=n,
                    trigger_sample=first + lead,
                    trigger_ticks=int((now_s - (n - lead) / rate_hz) * TICK_HZ),
                )
            ),
        )
        for at in range(0, n, 64):
            samples = Samples(
                first_sample=first + at, counts=counts[at : at + 64], block_id=self.block
            )
            self.out += self.frame(FrameType.BLOCK_DATA, encode_samples(samples), first=first + at)
        self.sent["blocks"] += 1

    def write(self) -> None:
        try:
            n = os.write(self.board, self.out[:65536])
        except BlockingIOError:
            return
        del self.out[:n]
        self.sent["bytes"] += n

    def run(self) -> None:
        listening, counter, next_can_s, turn_s = False, 0, 0.0, time.monotonic()
        while True:
            readable, _, _ = select.select([self.board, self.bus, sys.stdin], [], [], 0.002)
            now_s = time.monotonic()
            late, turn_s = now_s - turn_s > LATE_S, now_s
            if sys.stdin in readable:
                break
            if self.board in readable:
                self.answer()
            if self.bus in readable:
                for command in os.read(self.bus, 256).split(b"\r")[:-1]:
                    listening = listening or command == b"L"
                    os.write(self.bus, b"\r")
            if listening and now_s >= next_can_s:
                next_can_s = max(next_can_s + 0.008, now_s - 0.1)
                counter += 1
                angles = dict(zip(self.names, JOINTS.tolist(), strict=True))
                frames = self.encoder.encode(angles, drive_state=2, counter=counter)
                with suppress(BlockingIOError):  # an adapter drops what nobody fetches
                    os.write(self.bus, b"".join(encode_slcan(f.can_id, f.data) for f in frames))
            if self.running:
                due = int((now_s - self.started_s) * RATE_HZ)
                while self.sample + 64 <= due:
                    # A board drops its preview where the link has no room; 128 KiB is its buffer.
                    if len(self.out) < 131072:
                        self.out += self.stream_frame()
                        self.sent["stream_samples"] += 64
                    else:
                        self.sent["dropped_samples"] += 64
                        self.sent["dropped_late"] += 64 * late
                    self.sample += 64
                if self.held == 0 and now_s >= self.next_hit_s:
                    self.next_hit_s = now_s + HIT_EVERY_S
                    self.hit(now_s)
            if self.out:
                self.write()
        print(json.dumps(self.sent), flush=True)


if __name__ == "__main__":
    ask_for_priority()  # a board's converter waits for nobody
    Feeder().run()
