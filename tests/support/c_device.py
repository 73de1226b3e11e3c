"""The board of the C library on a link, a clock and a converter in the test's hand."""

import json
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from cobs import cobs

from armodal.protocols.board import (
    BoardDictionary,
    BoardStatus,
    Channel,
    FrameDecoder,
    FrameType,
    IepeState,
    decode_answer,
    decode_reply,
    encode_dictionary,
    encode_payload,
)
from armodal.protocols.c.library import device_library

VECTOR_FILE = Path(__file__).resolve().parents[1] / "vectors" / "board-v1.json"
VECTORS = json.loads(VECTOR_FILE.read_text(encoding="utf-8"))
SESSION = 0x5EED1234
FFI, C = device_library()


def entries(key):
    return pytest.mark.parametrize(
        "vector", VECTORS[key], ids=lambda vector: vector.get("name", "")
    )


def sealed(version, kind, payload=b"", *, session=SESSION, tag=0, sequence=0):
    """A frame of any version and type, with its delimiters."""
    body = struct.pack("<BBHIIHHQQ", version, kind, 0, session, sequence, 0, tag, 0, 0) + payload
    return b"\x00" + cobs.encode(body + zlib.crc32(body).to_bytes(4, "little")) + b"\x00"


def dictionary_of(n_channels=2, **changes):
    channels = tuple(
        Channel(
            name=f"c{i}",
            quantity="force",
            unit="N",
            scale=1.0,
            full_scale=1.0,
            iepe=IepeState.OFF,
            highpass_hz=0.0,
            serial_number="",
            calibration_date="",
            teds=b"",
        )
        for i in range(n_channels)
    )
    fields = {
        "board_id": "test",
        "firmware": "0",
        "link_bytes_per_s": 10_000_000,
        "block_capacity": 65_536,
        "tick_hz": 1_000_000,
        "filter_group_delay_samples": 0.0,
        "channels": channels,
    }
    return BoardDictionary(**(fields | changes))


def configuration_fields(configuration):
    """The record as the C struct."""
    return FFI.new(
        "ab_configuration *",
        {
            "rate_hz_numerator": configuration.rate_hz.numerator,
            "rate_hz_denominator": configuration.rate_hz.denominator,
            "channel_mask": configuration.channel_mask,
            "trigger_channel": configuration.trigger_channel,
            "trigger_level_counts": configuration.trigger_level_counts,
            "slope": configuration.slope,
            "stream": configuration.stream,
            "pretrigger": configuration.pretrigger,
            "block_length": configuration.block_length,
        },
    )


class Device:
    """A board after boot.

    `room` is how many bytes the link still takes, None for any number; `calls` what the converter
    was told.
    """

    def __init__(self, dictionary=None, *, n_blocks=64, preview_frames=32, receive_size=65):
        dictionary = dictionary or dictionary_of()
        self.encoded = encode_dictionary(dictionary)
        self.room = None
        self.now = 0
        self.calls = []
        self.decoder = FrameDecoder()
        self.frames = []
        n_channels = len(dictionary.channels)
        count_bytes = 192 * n_channels if n_channels <= 10 else 2040
        sizes = {
            "block_buffer": dictionary.block_capacity,
            "receive": receive_size,
            "transmit": 38 + max(516, 8 + count_bytes) + 9,
            "preview": preview_frames * (18 + count_bytes),
        }
        self.config = FFI.new("ab_config *")
        self.keep = [FFI.new("ab_block[]", n_blocks), FFI.from_buffer(self.encoded)]
        self.config.blocks, self.config.n_blocks = self.keep[0], n_blocks
        for name, size in sizes.items():
            self.keep.append(FFI.new("uint8_t[]", size))
            setattr(self.config, name, self.keep[-1])
            setattr(self.config, f"{name}_size", size)
        for name, signature, call in (
            ("send", "size_t(void *, const uint8_t *, size_t)", self._send),
            ("ticks", "uint64_t(void *)", lambda _: self.now),
            ("rate", "bool(void *, uint32_t, uint32_t, char *, size_t)", self._rate),
            ("start", "void(void *, uint32_t, uint32_t)", lambda _, a, b: self._note(a, b)),
            ("stop", "void(void *)", lambda _: self._note("stop")),
        ):
            self.keep.append(FFI.callback(signature, call))
            setattr(self.config.port, name, self.keep[-1])
        self.board = FFI.new("ab_board *")
        self.init = C.ab_init(self.board, self.config, self.keep[1], len(self.encoded), SESSION)

    def _send(self, _context, data, size):
        taken = size if self.room is None else min(size, self.room)
        if self.room is not None:
            self.room -= taken
        self.frames += self.decoder.feed(bytes(FFI.buffer(data, taken)))
        return taken

    def _rate(self, _context, numerator, _denominator, reason, _size):
        if numerator != 7:
            return True
        FFI.memmove(reason, b"not 7 Hz\0", 9)
        return False

    def _note(self, *call):
        self.calls.append(call)

    def receive(self, data):
        return C.ab_receive(self.board, data, len(data))

    def poll(self):
        return C.ab_poll(self.board)

    def ask(self, kind, payload=b"", *, version=1, session=SESSION, tag=9):
        """Send a command; return the frames that came of it."""
        seen = len(self.frames)
        data = sealed(version, kind, payload, session=session, tag=tag)
        assert self.receive(data) == len(data)
        self.poll()
        return self.frames[seen:]

    def code(self, kind, payload=b"", **fields):
        """Send a command; return the code of its answer."""
        return decode_reply(self.reply(kind, payload, **fields).payload)[0]

    def reply(self, kind, payload=b"", **fields):
        """Send a command; return its only answer among what else is sent."""
        (reply,) = [f for f in self.ask(kind, payload, **fields) if f.header.type == kind | 0x80]
        return reply

    def run(self, configuration):
        assert self.code(FrameType.CONFIGURE, encode_payload(configuration)) == 0
        assert self.code(FrameType.START) == 0

    def status(self):
        return decode_answer(BoardStatus, self.reply(FrameType.STATUS).payload)

    def feed(self, counts, ticks=0):
        counts = np.ascontiguousarray(counts, dtype=np.int32)
        C.ab_samples(self.board, FFI.from_buffer("int32_t[]", counts), len(counts), ticks)

    def of(self, kind):
        return [frame for frame in self.frames if frame.header.type is kind]


def accepts(encoded):
    """Whether C takes a dictionary."""
    return C.ab_dictionary_check(encoded, len(encoded), FFI.new("ab_dictionary_head *"))
