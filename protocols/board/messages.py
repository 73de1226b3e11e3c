"""Payloads of the messages between host and board.

The bytes are specified in `docs/board-protocol.md`, sections 4 to 8.
"""

from __future__ import annotations

import struct
from fractions import Fraction

from armodal.protocols.board.binary import Reader, pack
from armodal.protocols.board.dictionary import (
    decode_dictionary,
    dictionary_hash,
    encode_dictionary,
    hello_fragments,
    join_hello,
)
from armodal.protocols.board.records import (
    BlockInfo,
    BoardState,
    BoardStatus,
    Configuration,
    Frame,
    FrameType,
    ReplyCode,
    Samples,
    Slope,
)
from armodal.protocols.board.samples import BYTES_PER_COUNT, pack_counts, unpack_counts
from armodal.protocols.errors import FrameError

__all__ = [
    "BLOCK_PREFIX_SIZE",
    "STREAM_PREFIX_SIZE",
    "decode_block_info",
    "decode_configuration",
    "decode_dictionary",
    "decode_release",
    "decode_reply",
    "decode_resend",
    "decode_samples",
    "decode_status",
    "dictionary_hash",
    "encode_block_info",
    "encode_configuration",
    "encode_dictionary",
    "encode_release",
    "encode_reply",
    "encode_resend",
    "encode_samples",
    "encode_status",
    "hello_fragments",
    "join_hello",
]

_CONFIGURATION = struct.Struct("<IIIBBBBiII")
_BLOCK_INFO = struct.Struct("<IIQQQ")
_STATUS = struct.Struct("<BIQIIQII")
_STREAM = struct.Struct("<HBB")
_BLOCK = struct.Struct("<HBBI")
_RESEND = struct.Struct("<III")
_RELEASE = struct.Struct("<I")

_MAX_REASON = 255

STREAM_PREFIX_SIZE = _STREAM.size
BLOCK_PREFIX_SIZE = _BLOCK.size


def encode_configuration(configuration: Configuration) -> bytes:
    """Payload of CONFIGURE."""
    return pack(
        _CONFIGURATION,
        "CONFIGURE",
        configuration.rate_hz.numerator,
        configuration.rate_hz.denominator,
        configuration.channel_mask,
        configuration.trigger_channel,
        configuration.slope,
        configuration.stream,
        0,
        configuration.trigger_level_counts,
        configuration.pretrigger,
        configuration.block_length,
    )


def decode_configuration(payload: bytes) -> Configuration:
    """Read the payload of CONFIGURE; whether the board can do it is `limits.refusal`'s question."""
    reader = Reader(payload, "CONFIGURE")
    numerator, denominator, mask, channel, slope, stream, reserved, level, before, length = (
        reader.unpack(_CONFIGURATION)
    )
    reader.finish()
    if numerator == 0 or denominator == 0:
        raise FrameError(f"CONFIGURE: rate must be positive, got {numerator}/{denominator} Hz")
    if slope not in set(Slope) or stream > 1 or reserved != 0:
        raise FrameError(
            "CONFIGURE: slope 0...1, stream 0...1 and reserved 0 wanted, got "
            f"{slope}, {stream} and {reserved}"
        )
    return Configuration(
        rate_hz=Fraction(numerator, denominator),
        channel_mask=mask,
        trigger_channel=channel,
        trigger_level_counts=level,
        slope=Slope(slope),
        pretrigger=before,
        block_length=length,
        stream=bool(stream),
    )


def encode_block_info(info: BlockInfo) -> bytes:
    """Payload of BLOCK_READY."""
    return pack(
        _BLOCK_INFO,
        "BLOCK_READY",
        info.block_id,
        info.length,
        info.first_sample,
        info.trigger_sample,
        info.trigger_ticks,
    )


def decode_block_info(payload: bytes) -> BlockInfo:
    """Read the payload of BLOCK_READY."""
    reader = Reader(payload, "BLOCK_READY")
    block_id, length, first_sample, trigger_sample, trigger_ticks = reader.unpack(_BLOCK_INFO)
    reader.finish()
    if block_id == 0:
        raise FrameError("BLOCK_READY: block ids begin at 1, got 0")
    if not first_sample <= trigger_sample < first_sample + length:
        raise FrameError(
            f"BLOCK_READY: trigger sample {trigger_sample} is not among the {length} "
            f"samples from {first_sample}"
        )
    return BlockInfo(
        block_id=block_id,
        first_sample=first_sample,
        length=length,
        trigger_sample=trigger_sample,
        trigger_ticks=trigger_ticks,
    )


def encode_reply(code: ReplyCode, reason: str = "") -> bytes:
    """Payload of a reply; a reason longer than 255 bytes is cut at a character."""
    raw = reason.encode(errors="replace")[:_MAX_REASON]
    raw = raw.decode(errors="ignore").encode()
    return bytes([code, len(raw)]) + raw


def decode_reply(payload: bytes) -> tuple[ReplyCode, str]:
    """Code and reason at the head of a reply; what follows them is the reply's body."""
    return _read_reply(Reader(payload, "reply"))


def _read_reply(reader: Reader) -> tuple[ReplyCode, str]:
    number = reader.take(1)[0]
    if number not in set(ReplyCode):
        raise FrameError(f"reply code 0...{max(ReplyCode)} wanted, got {number}")
    return ReplyCode(number), reader.text()


def encode_status(status: BoardStatus) -> bytes:
    """Payload of STATUS_REPLY: code OK, no reason, and the status."""
    return encode_reply(ReplyCode.OK) + pack(
        _STATUS,
        "STATUS_REPLY",
        status.state,
        status.next_sequence,
        status.next_sample,
        status.buffered_blocks,
        status.oldest_block,
        status.stream_samples_dropped,
        status.triggers_missed,
        status.adc_overruns,
    )


def decode_status(payload: bytes) -> BoardStatus:
    """Read the payload of STATUS_REPLY; a refusal, which has no body, raises `FrameError`."""
    reader = Reader(payload, "STATUS_REPLY")
    code, reason = _read_reply(reader)
    if code != ReplyCode.OK:
        raise FrameError(f"STATUS_REPLY: status wanted, the board refused: {code.name} {reason}")
    state, sequence, sample, buffered, oldest, dropped, missed, overruns = reader.unpack(_STATUS)
    reader.finish()
    if state not in set(BoardState):
        raise FrameError(f"STATUS_REPLY: state 0...{max(BoardState)} wanted, got {state}")
    return BoardStatus(
        state=BoardState(state),
        next_sequence=sequence,
        next_sample=sample,
        buffered_blocks=buffered,
        oldest_block=oldest,
        stream_samples_dropped=dropped,
        triggers_missed=missed,
        adc_overruns=overruns,
    )


def encode_samples(samples: Samples) -> bytes:
    """Payload of STREAM, or of BLOCK_DATA where the samples name their block.

    The header that goes with it carries `samples.first_sample`.
    """
    data = pack_counts(samples.counts)
    n_samples, n_channels = samples.counts.shape
    if not data:
        raise FrameError("a frame holds at least one sample of one channel, got none")
    shape = (n_samples, n_channels, BYTES_PER_COUNT)
    if samples.block_id is None:
        return pack(_STREAM, "STREAM", *shape) + data
    return pack(_BLOCK, "BLOCK_DATA", *shape, samples.block_id) + data


def decode_samples(frame: Frame) -> Samples:
    """Read a STREAM or BLOCK_DATA frame.

    Returns
    -------
    Samples
        Counts (n_samples, n_channels), read-only.
    """
    payload = frame.payload
    block_id = None
    try:
        if frame.header.type is FrameType.STREAM:
            n_samples, n_channels, size = _STREAM.unpack_from(payload)
            offset = _STREAM.size
        elif frame.header.type is FrameType.BLOCK_DATA:
            n_samples, n_channels, size, block_id = _BLOCK.unpack_from(payload)
            offset = _BLOCK.size
        else:
            raise FrameError(f"STREAM or BLOCK_DATA wanted, got {frame.header.type.name}")
    except struct.error as error:
        raise FrameError(f"{frame.header.type.name}: the payload is too short: {error}") from error
    if size != BYTES_PER_COUNT or not n_samples or not n_channels or block_id == 0:
        raise FrameError(
            f"{frame.header.type.name}: {n_samples} samples of {n_channels} channels of {size} "
            f"bytes, block {block_id}: at least one of each and {BYTES_PER_COUNT} bytes wanted"
        )
    if len(payload) - offset != n_samples * n_channels * BYTES_PER_COUNT:
        raise FrameError(
            f"{frame.header.type.name}: {n_samples * n_channels * BYTES_PER_COUNT} bytes of "
            f"samples wanted, got {len(payload) - offset}"
        )
    counts = unpack_counts(payload, n_channels, offset)
    counts.setflags(write=False)
    return Samples(first_sample=frame.header.first_sample, counts=counts, block_id=block_id)


def encode_resend(block_id: int, first: int, count: int) -> bytes:
    """Payload of RESEND: samples `first` to `first + count - 1` of a held block.

    With a `count` of 0 the board only sends BLOCK_READY again.
    """
    return pack(_RESEND, "RESEND", block_id, first, count)


def decode_resend(payload: bytes) -> tuple[int, int, int]:
    """Read the payload of RESEND: block id, first offset in the block, count of samples."""
    reader = Reader(payload, "RESEND")
    block_id, first, count = reader.unpack(_RESEND)
    reader.finish()
    return block_id, first, count


def encode_release(block_id: int) -> bytes:
    """Payload of RELEASE."""
    return pack(_RELEASE, "RELEASE", block_id)


def decode_release(payload: bytes) -> int:
    """Read the payload of RELEASE: the block id."""
    reader = Reader(payload, "RELEASE")
    (block_id,) = reader.unpack(_RELEASE)
    reader.finish()
    return int(block_id)
