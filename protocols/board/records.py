"""The one table of the board protocol: frame types, and the record that each of them carries.

A field's annotation says how it stands on the wire, in the order of the wire. The codec comes from
it (`layout.py`); `python -m armodal.protocols.board.generate` writes the C header and sources, the
tables of `docs/board-protocol.md` and the test vectors of every field's extremes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from fractions import Fraction
from typing import Annotated, Any, ClassVar

import numpy as np
import numpy.typing as npt

from armodal.protocols.board.fields import (
    Rule,
    choice,
    constant,
    flag,
    flags,
    i32,
    rational,
    u8,
    u16,
    u32,
    u64,
)

__all__ = [
    "BYTES_PER_COUNT",
    "MESSAGES",
    "PROTOCOL_VERSION",
    "BlockDataHead",
    "BlockInfo",
    "BoardDictionary",
    "BoardState",
    "BoardStatus",
    "Channel",
    "Configuration",
    "FragmentHead",
    "Frame",
    "FrameType",
    "Header",
    "IepeState",
    "Message",
    "Overflow",
    "Release",
    "ReplyCode",
    "Resend",
    "Samples",
    "Slope",
    "StreamHead",
]

PROTOCOL_VERSION = 1
BYTES_PER_COUNT = 3


class FrameType(IntEnum):
    """What a frame carries; bit 7 set means device to host."""

    HELLO = 0x01
    CONFIGURE = 0x02
    START = 0x03
    STOP = 0x04
    STATUS = 0x05
    RESEND = 0x06
    RELEASE = 0x07
    HELLO_REPLY = 0x81
    CONFIGURE_REPLY = 0x82
    START_REPLY = 0x83
    STOP_REPLY = 0x84
    STATUS_REPLY = 0x85
    RESEND_REPLY = 0x86
    RELEASE_REPLY = 0x87
    STREAM = 0x90
    BLOCK_READY = 0x91
    BLOCK_DATA = 0x92


class Overflow(IntFlag):
    """Overflow flags in every header; sticky from START until the next START."""

    NONE = 0
    STREAM = 1  # preview samples were dropped because the link was full
    BLOCK = 2  # a trigger was missed because no block buffer was free
    ADC = 4  # the converter lost samples: the sample index jumped


class ReplyCode(IntEnum):
    """First byte of every reply's payload (HELLO_REPLY excepted)."""

    OK = 0
    BAD_VALUE = 1
    CAPACITY = 2
    LINK = 3
    WRONG_STATE = 4
    UNKNOWN_BLOCK = 5
    UNKNOWN_COMMAND = 6
    WRONG_SESSION = 7


class BoardState(IntEnum):
    """State of the board as STATUS_REPLY tells it."""

    IDLE = 0
    CONFIGURED = 1
    RUNNING = 2


class Slope(IntEnum):
    """Sign of the crossing that triggers."""

    RISING = 0
    FALLING = 1


class IepeState(IntEnum):
    """State of a channel's IEPE supply."""

    OFF = 0
    OK = 1
    OPEN = 2
    SHORT = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """The 32 bytes in front of every payload.

    `first_sample` is the index, since START, of the first sample the payload holds (0 where it
    holds none); `ticks` the device's clock when the frame was composed, for data frames when its
    first sample was taken.
    """

    version: ClassVar[Annotated[int, constant("u8", PROTOCOL_VERSION, "of the protocol")]]
    type: Annotated[FrameType, u8("section 4; bit 7 set: from board to host")]
    dictionary_hash: Annotated[
        int,
        u16(
            "board: hash of its dictionary (section 5). Host: 0 or that hash; the board ignores it"
        ),
    ] = 0
    session: Annotated[
        int,
        u32("board: its session id. Host: the session id it talks to; 0 in a HELLO"),
    ]
    sequence: Annotated[int, u32("number of this frame among the sender's frames")]
    overflow: Annotated[Overflow, flags("board: flags below. Host: 0")] = Overflow.NONE
    tag: Annotated[
        int, u16("command: chosen by the host. Reply: that of its command. Otherwise 0")
    ] = 0
    first_sample: Annotated[
        int, u64("STREAM, BLOCK_DATA: index of the first sample carried. Otherwise 0")
    ] = 0
    ticks: Annotated[int, u64("board: its clock. Host: 0", unit="ticks")] = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """A decoded frame."""

    header: Header
    payload: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One input of the board as its dictionary describes it."""

    name: str
    quantity: str  # "force" or "acceleration"
    unit: str  # SI: "N", "m/s^2"
    scale: float  # unit per count
    full_scale: float  # largest magnitude the input can represent, in unit
    iepe: IepeState
    highpass_hz: float  # first-order corner of sensor and coupling together; 0 is DC coupled
    serial_number: str
    calibration_date: str  # ISO 8601 date, or empty
    teds: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardDictionary:
    """What HELLO returns: the board and its channels describe themselves."""

    board_id: str
    firmware: str
    link_bytes_per_s: int
    block_capacity: int  # bytes of block buffer (3 per sample and channel)
    tick_hz: int
    filter_group_delay_samples: float
    channels: tuple[Channel, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FragmentHead:
    """HELLO_REPLY: what stands before its bytes of the dictionary."""

    total: Annotated[int, u16("length of the array", low=1, unit="bytes")]
    offset: Annotated[int, u16("of this fragment", unit="bytes")]

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(
            words="offset must be below total",
            holds=lambda m: m.offset < m.total,
            c="m->offset < m->total",
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Configuration:
    """CONFIGURE: what the host wants measured."""

    rate_hz: Annotated[
        Fraction, rational("the exact quotient: 51200/31 is 51200 and 31", unit="Hz")
    ]
    channel_mask: Annotated[int, u32("bit i: channel i; not 0; only channels of the dictionary")]
    trigger_channel: Annotated[int, u8("index into the dictionary; must be in the mask")]
    slope: Annotated[Slope, choice("sign of the crossing that triggers")]
    stream: Annotated[bool, flag("preview wanted")]
    reserved: ClassVar[Annotated[int, constant("u8", 0, "")]]
    trigger_level_counts: Annotated[
        int, i32("on the trigger channel; its magnitude at most 8388607", unit="counts")
    ]
    pretrigger: Annotated[int, u32("before the trigger sample; below block_length", unit="samples")]
    block_length: Annotated[int, u32("pre-trigger included", unit="samples")]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardStatus:
    """STATUS_REPLY; the device clock at the reply is in the header."""

    state: Annotated[BoardState, choice("section 4.1")]
    next_sequence: Annotated[int, u32("sequence number of the frame after this one")]
    next_sample: Annotated[int, u64("index the next sample will get")]
    buffered_blocks: Annotated[int, u32("complete blocks held")]
    oldest_block: Annotated[int, u32("id of the oldest of them; 0 where none is held")]
    stream_samples_dropped: Annotated[
        int, u64("that were not put into the preview, since START", unit="samples")
    ]
    triggers_missed: Annotated[
        int, u32("triggers without a free buffer and blocks given up for ADC, since START")
    ]
    adc_overruns: Annotated[int, u32("times the converter lost samples, since START")]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockInfo:
    """BLOCK_READY: a triggered block the board holds until it is released."""

    block_id: Annotated[int, u32("of the block", low=1)]
    length: Annotated[int, u32("of the block", unit="samples")]
    first_sample: Annotated[int, u64("index of its first sample")]
    trigger_sample: Annotated[int, u64("index of the trigger sample")]
    trigger_ticks: Annotated[int, u64("clock when the trigger sample was ready", unit="ticks")]

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(
            words="trigger_sample must lie in the block",
            holds=lambda m: 0 <= m.trigger_sample - m.first_sample < m.length,
            c="m->trigger_sample - m->first_sample < m->length",  # unsigned: wraps below 0
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Resend:
    """RESEND: samples of a held block that are wanted once more."""

    block_id: Annotated[int, u32("of the block")]
    first: Annotated[int, u32("offset in the block of the first sample wanted", unit="samples")]
    count: Annotated[int, u32("wanted; 0 asks for BLOCK_READY alone", unit="samples")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """RELEASE: a block that the host has on its disk."""

    block_id: Annotated[int, u32("of the block")]


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamHead:
    """STREAM: what stands before its counts."""

    n_samples: Annotated[int, u16("samples", low=1)]
    n_channels: Annotated[int, u8("channels", low=1)]
    bytes_per_count: ClassVar[Annotated[int, constant("u8", BYTES_PER_COUNT, "")]]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockDataHead:
    """BLOCK_DATA: what stands before its counts."""

    n_samples: Annotated[int, u16("samples", low=1)]
    n_channels: Annotated[int, u8("channels", low=1)]
    bytes_per_count: ClassVar[Annotated[int, constant("u8", BYTES_PER_COUNT, "")]]
    block_id: Annotated[int, u32("of the block", low=1)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Raw counts of a STREAM or BLOCK_DATA frame."""

    first_sample: int
    counts: npt.NDArray[np.int32]  # (n_samples, n_channels)
    block_id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """What the payload of a frame type is.

    section : of the document that explains it
    record : its fixed fields; None where it has none
    tail : what follows them, in words; empty where nothing does
    is_answer : whether code and reason of a reply stand in front
    note : of an answer's record, the sentence of it that a session notes before its first hit. The
        host then asks for it; a board that refuses has none, and the session goes on.
    """

    section: int = 4
    record: type | None = None
    tail: str = ""
    is_answer: bool = False
    note: Callable[[Any], str] | None = None


MESSAGES: Mapping[FrameType, Message] = {
    FrameType.HELLO: Message(section=5),
    FrameType.CONFIGURE: Message(section=6, record=Configuration),
    FrameType.START: Message(),
    FrameType.STOP: Message(),
    FrameType.STATUS: Message(section=7),
    FrameType.RESEND: Message(section=8, record=Resend),
    FrameType.RELEASE: Message(section=8, record=Release),
    FrameType.HELLO_REPLY: Message(section=5, record=FragmentHead, tail="bytes of the dictionary"),
    FrameType.CONFIGURE_REPLY: Message(is_answer=True),
    FrameType.START_REPLY: Message(is_answer=True),
    FrameType.STOP_REPLY: Message(is_answer=True),
    FrameType.STATUS_REPLY: Message(section=7, record=BoardStatus, is_answer=True),
    FrameType.RESEND_REPLY: Message(is_answer=True),
    FrameType.RELEASE_REPLY: Message(is_answer=True),
    FrameType.STREAM: Message(section=9, record=StreamHead, tail="counts"),
    FrameType.BLOCK_READY: Message(section=8, record=BlockInfo),
    FrameType.BLOCK_DATA: Message(section=9, record=BlockDataHead, tail="counts"),
}
