"""The records behind the board protocol's test vectors: every message type, and its extremes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from armodal.protocols.board import (
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Channel,
    Configuration,
    FrameType,
    Header,
    IepeState,
    Overflow,
    Release,
    ReplyCode,
    Resend,
    Samples,
    Slope,
    dictionary_hash,
    encode_answer,
    encode_dictionary,
    encode_payload,
    encode_reply,
    encode_samples,
    hello_fragments,
)

SESSION = 0x5EED1234

HAMMER = Channel(
    name="hammer",
    quantity="force",
    unit="N",
    scale=1 / 2048,
    full_scale=4096.0,
    iepe=IepeState.OK,
    highpass_hz=0.0,
    serial_number="H-0042",
    calibration_date="2025-03-14",
    teds=b"",
)
ACCELEROMETER = Channel(
    name="acc_x",
    quantity="acceleration",
    unit="m/s^2",
    scale=-2.384185791015625e-05,
    full_scale=200.0,
    iepe=IepeState.OPEN,
    highpass_hz=0.5,
    serial_number="",
    calibration_date="",
    teds=bytes.fromhex("1b00c0ffee"),
)
TWO_CHANNELS = BoardDictionary(
    board_id="bench board",
    firmware="1.2.0",
    link_bytes_per_s=200_000,
    block_capacity=65_536,
    tick_hz=10_000_000,
    filter_group_delay_samples=34.5,
    channels=(HAMMER, ACCELEROMETER),
)
FOUR_CHANNELS = replace(
    TWO_CHANNELS,
    board_id="Prüfstand µ",
    channels=(
        HAMMER,
        ACCELEROMETER,
        replace(ACCELEROMETER, name="acc_y", teds=bytes(range(256)) * 2),
        replace(ACCELEROMETER, name="acc_z", iepe=IepeState.OFF),
    ),
)
DICTIONARIES = {"two channels": TWO_CHANNELS, "four channels, long TEDS": FOUR_CHANNELS}

CONFIGURATION = Configuration(
    rate_hz=Fraction(51_200, 31),
    channel_mask=0b11,
    trigger_channel=0,
    trigger_level_counts=20_000,
    slope=Slope.RISING,
    pretrigger=100,
    block_length=2048,
    stream=True,
)
CONFIGURATIONS = {
    "accepted": CONFIGURATION,
    "mask empty": replace(CONFIGURATION, channel_mask=0),
    "mask names a channel that is not there": replace(CONFIGURATION, channel_mask=0b111),
    "trigger channel not in mask": replace(CONFIGURATION, channel_mask=0b10),
    "trigger level out of range": replace(CONFIGURATION, trigger_level_counts=1 << 23),
    "pre-trigger as long as the block": replace(CONFIGURATION, pretrigger=2048),
    "block exactly fills the buffer": replace(CONFIGURATION, block_length=10_922),
    "block one sample too long": replace(CONFIGURATION, block_length=10_923),
    "stream too fast": replace(CONFIGURATION, rate_hz=Fraction(51_200)),
    "fast without stream": replace(CONFIGURATION, rate_hz=Fraction(51_200), stream=False),
}
SLOW_LINK = replace(TWO_CHANNELS, link_bytes_per_s=1000)

BLOCK_INFO = BlockInfo(
    block_id=7,
    first_sample=1_000_000_000_000,
    length=2048,
    trigger_sample=1_000_000_000_100,
    trigger_ticks=0xFEDCBA9876543210,
)
STATUS = BoardStatus(
    state=BoardState.RUNNING,
    next_sequence=0,
    next_sample=123_456_789_012,
    buffered_blocks=2,
    oldest_block=7,
    stream_samples_dropped=64,
    triggers_missed=1,
    adc_overruns=0,
)
SMALL_COUNTS = np.array([[1, -1], [8_388_607, -8_388_608]], dtype=np.int32)
# No byte of these counts is zero: the longest stretches COBS can meet.
FULL_COUNTS = (np.arange(256, dtype=np.int32).reshape(64, 4) * 3 % 250 + 1) * 0x010101 - 0x7F7F7F
COUNTS = {
    "extremes": SMALL_COUNTS,
    "one count": np.array([[-2]], dtype=np.int32),
    "full frame": FULL_COUNTS,
}

# One entry a frame: name, type, payload, first sample, overflow flags.
MESSAGES: tuple[tuple[str, FrameType, bytes, int, Overflow], ...] = (
    ("hello", FrameType.HELLO, b"", 0, Overflow.NONE),
    (
        "hello reply",
        FrameType.HELLO_REPLY,
        hello_fragments(encode_dictionary(TWO_CHANNELS))[0],
        0,
        Overflow.NONE,
    ),
    ("configure", FrameType.CONFIGURE, encode_payload(CONFIGURATION), 0, Overflow.NONE),
    (
        "configure, negative level, falling",
        FrameType.CONFIGURE,
        encode_payload(
            replace(
                CONFIGURATION,
                slope=Slope.FALLING,
                stream=False,
                trigger_level_counts=-8_388_607,
            )
        ),
        0,
        Overflow.NONE,
    ),
    ("configure reply", FrameType.CONFIGURE_REPLY, encode_reply(ReplyCode.OK), 0, Overflow.NONE),
    (
        "configure refused",
        FrameType.CONFIGURE_REPLY,
        encode_reply(ReplyCode.CAPACITY, "24576 B wanted, 16384 B there"),
        0,
        Overflow.NONE,
    ),
    (
        "long reason",
        FrameType.CONFIGURE_REPLY,
        encode_reply(ReplyCode.BAD_VALUE, "x" * 248),
        0,
        Overflow.NONE,
    ),
    ("start", FrameType.START, b"", 0, Overflow.NONE),
    ("start reply", FrameType.START_REPLY, encode_reply(ReplyCode.OK), 0, Overflow.NONE),
    ("stop", FrameType.STOP, b"", 0, Overflow.NONE),
    ("stop reply", FrameType.STOP_REPLY, encode_reply(ReplyCode.OK), 0, Overflow.NONE),
    ("status", FrameType.STATUS, b"", 0, Overflow.NONE),
    (
        "status reply",
        FrameType.STATUS_REPLY,
        encode_answer(STATUS),
        0,
        Overflow.STREAM | Overflow.BLOCK,
    ),
    (
        "resend",
        FrameType.RESEND,
        encode_payload(Resend(block_id=7, first=64, count=128)),
        0,
        Overflow.NONE,
    ),
    (
        "resend block ready alone",
        FrameType.RESEND,
        encode_payload(Resend(block_id=7, first=0, count=Overflow.NONE)),
        0,
        0,
    ),
    (
        "resend refused",
        FrameType.RESEND_REPLY,
        encode_reply(ReplyCode.UNKNOWN_BLOCK, "Block 7 µ"),
        0,
        Overflow.NONE,
    ),
    ("release", FrameType.RELEASE, encode_payload(Release(block_id=7)), 0, Overflow.NONE),
    ("release reply", FrameType.RELEASE_REPLY, encode_reply(ReplyCode.OK), 0, Overflow.NONE),
    ("block ready", FrameType.BLOCK_READY, encode_payload(BLOCK_INFO), 0, Overflow.NONE),
    (
        "stream",
        FrameType.STREAM,
        encode_samples(Samples(first_sample=4096, counts=SMALL_COUNTS)),
        4096,
        Overflow.STREAM,
    ),
    (
        "block data, full frame without zeros",
        FrameType.BLOCK_DATA,
        encode_samples(Samples(first_sample=0, counts=FULL_COUNTS, block_id=7)),
        1_000_000_000_064,
        Overflow.ADC,
    ),
)


def header_of(index: int, kind: FrameType, first_sample: int, overflow: Overflow) -> Header:
    """A header with every field its own: numbers that differ from frame to frame."""
    from_board = kind >= 0x80
    data = kind >= FrameType.STREAM
    return Header(
        type=kind,
        session=0 if kind is FrameType.HELLO else SESSION,
        sequence=(0xFFFFFFFD + index) % (1 << 32),
        dictionary_hash=dictionary_hash(encode_dictionary(TWO_CHANNELS)),
        overflow=overflow,
        tag=0 if data else 0xA000 + index,
        first_sample=first_sample,
        ticks=0x0123456789 * (index + 1) if from_board else 0,
    )
