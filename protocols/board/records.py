"""Records of the acquisition-board protocol: what the two sides agree on.

The bytes are specified in `docs/board-protocol.md`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag
from fractions import Fraction

import numpy as np
import numpy.typing as npt

__all__ = [
    "BlockInfo",
    "BoardDictionary",
    "BoardState",
    "BoardStatus",
    "Channel",
    "Configuration",
    "Frame",
    "FrameType",
    "Header",
    "IepeState",
    "Overflow",
    "ReplyCode",
    "Samples",
    "Slope",
]


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

    type: FrameType
    session: int  # u32, random per boot; 0 in a HELLO from the host
    sequence: int  # u32, per sender, +1 a frame, wraps
    dictionary_hash: int = 0  # u16
    overflow: Overflow = Overflow.NONE
    tag: int = 0  # u16, chosen by the host in a command, echoed in its reply
    first_sample: int = 0  # u64
    ticks: int = 0  # u64


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
class Configuration:
    """What CONFIGURE asks for."""

    rate_hz: Fraction
    channel_mask: int  # bit i: channel i of the dictionary
    trigger_channel: int  # index into the dictionary
    trigger_level_counts: int
    slope: Slope
    pretrigger: int  # samples
    block_length: int  # samples, pre-trigger included
    stream: bool  # free-running preview wanted


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockInfo:
    """BLOCK_READY: a triggered block the board holds until it is released."""

    block_id: int
    first_sample: int
    length: int
    trigger_sample: int
    trigger_ticks: int


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardStatus:
    """STATUS_REPLY; the device clock at the reply is in the header."""

    state: BoardState
    next_sequence: int
    next_sample: int
    buffered_blocks: int
    oldest_block: int  # id, 0 where none is held
    stream_samples_dropped: int
    triggers_missed: int
    adc_overruns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Raw counts of a STREAM or BLOCK_DATA frame."""

    first_sample: int
    counts: npt.NDArray[np.int32]  # (n_samples, n_channels)
    block_id: int | None = None
