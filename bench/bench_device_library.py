"""The device library in C: its codec's speed, and what the simulated board takes of a core.

OPENBLAS_NUM_THREADS=1 .venv/bin/python bench/bench_device_library.py [seconds]

Exit code 1 where encoder or decoder is below 200 MB/s of wire bytes, or the board at 4 x 51.2 kS/s
takes 15 % of a core or more, all by processor time. The library is compiled as the simulated board
uses it (-O3, fast CRC tables); with the small table of a microcontroller the codec is slower, which
is told as well.

The share is that of a process in which nothing but the board's loop runs: pseudo-terminal,
commands, capture, preview, framing, and the loop's own waiting, as in `hil_sim.lab_process`. The
samples come from an array made beforehand, so the plant is not in it; the host reads in a process
of its own.
"""

from __future__ import annotations

import multiprocessing
import os
import select
import statistics
import sys
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from cffi import FFI

from armodal.hil_sim.board import Board
from armodal.hil_sim.board_state import BoardFirmware, Converter
from armodal.hil_sim.clock import DeviceClock, LabClock
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.lab_process import TICK_S
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.streams import stream
from armodal.protocols.board import (
    BoardDictionary,
    BoardStatus,
    Channel,
    Configuration,
    FrameDecoder,
    FrameType,
    Header,
    IepeState,
    Release,
    Samples,
    SequenceTracker,
    Slope,
    decode_answer,
    decode_samples,
    encode_frame,
    encode_payload,
    encode_samples,
)
from armodal.protocols.c.build import HEADERS, INCLUDE, SOURCES, STRICT, compile_with, compilers
from armodal.protocols.c.library import declarations

RATE_HZ, N_CHANNELS, N_SAMPLES = 51_200, 4, 64
N_FRAMES, ROUNDS = 2000, 15
WANTED_MB_S, WANTED_SHARE = 200.0, 0.15
SESSION = 7
# The noise crosses this level a few times a second: blocks are sent beside the preview.
WANTED = Configuration(
    rate_hz=Fraction(RATE_HZ),
    channel_mask=(1 << N_CHANNELS) - 1,
    trigger_channel=0,
    trigger_level_counts=300_000,
    slope=Slope.RISING,
    pretrigger=200,
    block_length=2048,
    stream=True,
)


def payloads() -> list[bytes]:
    """Frames of noise with the amplitude of a measurement at one hundredth of full scale."""
    rng = np.random.default_rng(0)
    return [
        encode_samples(
            Samples(
                first_sample=0,
                counts=rng.normal(0.0, 8e4, (N_SAMPLES, N_CHANNELS)).astype(np.int32),
            )
        )
        for _ in range(N_FRAMES)
    ]


# The loops over frames are in C, so that calls from Python are not what is measured.
LOOPS = """
#include "armodal_board.h"

size_t encode_all(uint8_t *wire, size_t room, const uint8_t *payloads, size_t size, size_t n)
{
    size_t at = 0;

    for (size_t i = 0; i < n; i++) {
        ab_header header = {0};
        ab_encoder encoder;

        header.version = 1;
        header.type = AB_STREAM;
        header.sequence = (uint32_t)i;
        ab_encoder_begin(&encoder, wire + at, room - at, &header);
        ab_encoder_add(&encoder, payloads + i * size, size);
        at += ab_encoder_end(&encoder);
    }
    return at;
}

size_t decode_all(ab_receiver *receiver, const uint8_t *wire, size_t n)
{
    size_t at = 0;
    size_t found = 0;

    while (at < n) {
        /* 4095 bytes: the most a pseudo-terminal returns */
        size_t end = n - at < 4095 ? n : at + 4095;

        while (at < end) {
            size_t stretch, size;
            const uint8_t *payload;
            ab_header header;

            at += ab_receiver_take(receiver, wire + at, end - at, &stretch);
            if (stretch > 0)
                found += ab_receiver_decode(receiver, stretch, &header, &payload, &size) ==
                         AB_FRAME_OK;
        }
    }
    return found;
}
"""


def library(folder: Path, *options: str) -> tuple[Any, Any]:
    source, made = folder / "loops.c", folder / f"loops{len(list(folder.iterdir()))}.so"
    source.write_text(LOOPS, encoding="utf-8")
    arguments = [*STRICT, *options, "-fPIC", "-shared", f"-I{INCLUDE}", str(source)]
    said = compile_with(next(compilers()), [*arguments, *map(str, SOURCES)], made)
    if said:
        raise RuntimeError(said)
    ffi = FFI()
    for header in HEADERS:
        ffi.cdef(declarations(header))
    ffi.cdef("size_t encode_all(uint8_t *, size_t, const uint8_t *, size_t, size_t);")
    ffi.cdef("size_t decode_all(ab_receiver *, const uint8_t *, size_t);")
    return ffi, ffi.dlopen(str(made))


def codec_mb_s(folder: Path, *options: str) -> tuple[float, float]:
    """Median encoding and decoding speed, MB of wire bytes a second."""
    ffi, compiled = library(folder, *options)
    pieces = payloads()
    joined, size = b"".join(pieces), len(pieces[0])
    wire = ffi.new("uint8_t[]", N_FRAMES * (size + 60))
    receiver = ffi.new("ab_receiver *")
    buffer = ffi.new("uint8_t[]", compiled.AB_MAX_ENCODED)
    receiver.buffer, receiver.size = buffer, len(buffer)
    encode_s, decode_s = [], []
    for _ in range(ROUNDS):
        start = time.process_time()
        n = compiled.encode_all(wire, len(wire), joined, size, N_FRAMES)
        between = time.process_time()
        found = compiled.decode_all(receiver, wire, n)
        decode_s.append(time.process_time() - between)
        encode_s.append(between - start)
        assert found == N_FRAMES
    assert bytes(ffi.buffer(wire, n))[:900].startswith(
        encode_frame(Header(type=FrameType.STREAM, session=0, sequence=0), pieces[0])
    )
    return n / 1e6 / statistics.median(encode_s), n / 1e6 / statistics.median(decode_s)


class ArraySource:
    """Samples out of an array, again and again."""

    def __init__(self) -> None:
        rng = np.random.default_rng(1)
        self._counts = rng.normal(0.0, 8e4, (RATE_HZ, N_CHANNELS)).astype(np.int32)
        self._at = 0

    def read(self, n: int) -> np.ndarray[Any, np.dtype[np.int32]]:
        if self._at + n > len(self._counts):
            self._at = 0
        self._at += n
        return self._counts[self._at - n : self._at]


def dictionary() -> BoardDictionary:
    channels = tuple(
        Channel(
            name=f"c{i}",
            quantity="acceleration",
            unit="m/s^2",
            scale=1e-5,
            full_scale=80.0,
            iepe=IepeState.OK,
            highpass_hz=0.1,
            serial_number="",
            calibration_date="",
            teds=b"",
        )
        for i in range(N_CHANNELS)
    )
    return BoardDictionary(
        board_id="bench",
        firmware="1",
        link_bytes_per_s=1_000_000,
        block_capacity=512 * 1024,
        tick_hz=1_000_000,
        filter_group_delay_samples=0.0,
        channels=channels,
    )


def run_board(pipe: Connection, seconds: float) -> None:
    """The board's process: its port first, then its use of the processor."""
    clock = LabClock()
    source = ArraySource()
    firmware = BoardFirmware(
        dictionary(),
        session=SESSION,
        clock=DeviceClock(lab=clock, boot_s=clock.now_s()),
        converter=Converter(start=lambda _rate: None, stop=lambda: None, read=source.read),
    )
    with closing(PtyPort()) as port:
        board = Board(firmware, port, faults=FaultSet(), streams=partial(stream, 2))

        def turn() -> None:
            writers = [port.fileno()] if board.wants_write else []
            select.select([port.fileno()], writers, [], TICK_S)
            board.step()

        pipe.send(port.name)
        while not firmware.running:
            turn()
        before, begin = time.process_time(), time.monotonic()
        while time.monotonic() < begin + seconds:
            turn()
        pipe.send((time.process_time() - before) / (time.monotonic() - begin))
        while not pipe.poll():
            turn()


@dataclass(slots=True)
class Host:
    """The other end of the line: releases every block once it has come."""

    fd: int
    decoder: FrameDecoder = field(default_factory=FrameDecoder)
    tracker: SequenceTracker = field(default_factory=SequenceTracker)
    samples: int = 0
    blocks: int = 0
    status: BoardStatus | None = None

    def send(self, kind: FrameType, payload: bytes = b"") -> None:
        os.write(self.fd, encode_frame(Header(type=kind, session=SESSION, sequence=0), payload))

    def pump(self) -> None:
        if not select.select([self.fd], [], [], 0.01)[0]:
            return
        for frame in self.decoder.feed(os.read(self.fd, 65_536)):
            self.tracker.check(frame.header)
            if frame.header.type is FrameType.STREAM:
                self.samples += int.from_bytes(frame.payload[:2], "little")
            elif frame.header.type is FrameType.BLOCK_DATA:
                self._release_complete(decode_samples(frame))
            elif frame.header.type is FrameType.STATUS_REPLY:
                self.status = decode_answer(BoardStatus, frame.payload)

    def _release_complete(self, samples: Samples) -> None:
        # Of the 2048 samples of a block the last frame carries 64 as well: none is torn.
        self.blocks += len(samples.counts)
        if self.blocks % WANTED.block_length == 0:
            self.send(FrameType.RELEASE, encode_payload(Release(block_id=samples.block_id or 0)))


def board_share(seconds: float) -> tuple[float, Host]:
    """Share of a core that the board's process takes, and what its host has seen."""
    context = multiprocessing.get_context("spawn")
    pipe, other = context.Pipe()
    process = context.Process(target=run_board, args=(other, seconds))
    process.start()
    host = Host(os.open(pipe.recv(), os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK))
    host.send(FrameType.CONFIGURE, encode_payload(WANTED))
    host.send(FrameType.START)
    while not pipe.poll():
        host.pump()
    share = float(pipe.recv())
    host.send(FrameType.STATUS)
    while host.status is None:
        host.pump()
    pipe.send("end")
    process.join()
    os.close(host.fd)
    return share, host


def main() -> int:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    with tempfile.TemporaryDirectory() as name:
        fast = codec_mb_s(Path(name), "-O3", "-DAB_FAST_CRC=1")
        small = codec_mb_s(Path(name), "-Os", "-DAB_FAST_CRC=0")
    print(
        f"codec -O3, fast CRC: encode {fast[0]:.0f} MB/s, decode {fast[1]:.0f} MB/s "
        f"(wanted: {WANTED_MB_S:.0f} MB/s each)"
    )
    print(f"codec -Os, small CRC: encode {small[0]:.0f} MB/s, decode {small[1]:.0f} MB/s")
    share, host = board_share(seconds)
    status = host.status
    assert status is not None
    print(
        f"simulated board at {N_CHANNELS} x {RATE_HZ / 1000:g} kS/s for {seconds:g} s: "
        f"{100 * share:.1f} % of a core (wanted: below {100 * WANTED_SHARE:.0f} %)"
    )
    print(
        f"  {status.next_sample} samples taken, {host.samples} in the preview, "
        f"{status.stream_samples_dropped} dropped, {host.blocks // WANTED.block_length} blocks, "
        f"{status.triggers_missed} triggers missed, {host.tracker.missing} frames missing"
    )
    return 0 if min(fast) >= WANTED_MB_S and share < WANTED_SHARE else 1


if __name__ == "__main__":
    sys.exit(main())
