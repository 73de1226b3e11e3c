"""Payloads of the messages between host and board.

The bytes are specified in `docs/board-protocol.md`, sections 4 to 9; the fixed fields of each
payload are a record of `records.py`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

from armodal.protocols.board.binary import Reader
from armodal.protocols.board.dictionary import (
    decode_dictionary,
    dictionary_hash,
    encode_dictionary,
    hello_fragments,
    join_hello,
)
from armodal.protocols.board.layout import decode, encode, layout_of
from armodal.protocols.board.records import (
    BYTES_PER_COUNT,
    MESSAGES,
    BlockDataHead,
    Frame,
    FrameType,
    ReplyCode,
    Samples,
    StreamHead,
)
from armodal.protocols.board.samples import pack_counts, unpack_counts
from armodal.protocols.errors import FrameError

__all__ = [
    "BLOCK_HEAD_SIZE",
    "STREAM_HEAD_SIZE",
    "decode_answer",
    "decode_dictionary",
    "decode_payload",
    "decode_reply",
    "decode_samples",
    "dictionary_hash",
    "encode_answer",
    "encode_dictionary",
    "encode_payload",
    "encode_reply",
    "encode_samples",
    "hello_fragments",
    "join_hello",
]

Record = TypeVar("Record")

_MAX_REASON = 255
_NAMES = {message.record: kind.name for kind, message in MESSAGES.items() if message.record}

STREAM_HEAD_SIZE = layout_of(StreamHead).size
BLOCK_HEAD_SIZE = layout_of(BlockDataHead).size


def _name(record: type) -> str:
    return _NAMES.get(record, record.__name__)


def encode_payload(record: object) -> bytes:
    """Payload of the message whose record this is.

    Its values need only fit their widths: what a board has to refuse can be sent.

    Raises
    ------
    FrameError
        If one does not.
    """
    return encode(record, _name(type(record)))


def decode_payload(record: type[Record], payload: bytes) -> Record:
    """Read the payload of the message whose record `record` is.

    Of a `Configuration`, whether the board can do it is `limits.refusal`'s question.

    Raises
    ------
    FrameError
        If the length is another or a value breaks a rule of its field.
    """
    return decode(record, payload, _name(record))


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


def encode_answer(record: object) -> bytes:
    """Payload of a reply that carries a record: code OK, no reason, and the record."""
    return encode_reply(ReplyCode.OK) + encode_payload(record)


def decode_answer(record: type[Record], payload: bytes) -> Record:
    """Read the record that a reply carries.

    Raises
    ------
    FrameError
        If the board refused, which leaves no record, or the record is malformed.
    """
    reader = Reader(payload, _name(record))
    code, reason = _read_reply(reader)
    if code != ReplyCode.OK:
        raise FrameError(
            f"{_name(record)}: an answer wanted, the board refused: {code.name} {reason}"
        )
    return decode_payload(record, reader.rest())


def encode_samples(samples: Samples) -> bytes:
    """Payload of STREAM, or of BLOCK_DATA where the samples name their block.

    The header that goes with it carries `samples.first_sample`.
    """
    data = pack_counts(samples.counts)
    n_samples, n_channels = samples.counts.shape
    if not data:
        raise FrameError("a frame holds at least one sample of one channel, got none")
    if samples.block_id is None:
        return encode_payload(StreamHead(n_samples=n_samples, n_channels=n_channels)) + data
    head = BlockDataHead(n_samples=n_samples, n_channels=n_channels, block_id=samples.block_id)
    return encode_payload(head) + data


def decode_samples(frame: Frame) -> Samples:
    """Read a STREAM or BLOCK_DATA frame.

    Returns
    -------
    Samples
        Counts (n_samples, n_channels), read-only.
    """
    payload, kind = frame.payload, frame.header.type
    if kind not in (FrameType.STREAM, FrameType.BLOCK_DATA):
        raise FrameError(f"STREAM or BLOCK_DATA wanted, got {kind.name}")
    offset = STREAM_HEAD_SIZE if kind is FrameType.STREAM else BLOCK_HEAD_SIZE
    n_channels, n_bytes, block_id = _sample_head(kind, payload[:offset])
    if len(payload) - offset != n_bytes:
        raise FrameError(
            f"{kind.name}: {n_bytes} bytes of samples wanted, got {len(payload) - offset}"
        )
    counts = unpack_counts(payload, n_channels, offset)
    counts.setflags(write=False)
    return Samples(first_sample=frame.header.first_sample, counts=counts, block_id=block_id)


# Most frames of a run have the same head.
@lru_cache(maxsize=16)
def _sample_head(kind: FrameType, data: bytes) -> tuple[int, int, int | None]:
    """Channels, bytes of counts and block id that the head of a data frame tells."""
    head: StreamHead | BlockDataHead
    if kind is FrameType.STREAM:
        head, block_id = decode(StreamHead, data, kind.name), None
    else:
        head = decode(BlockDataHead, data, kind.name)
        block_id = head.block_id
    return head.n_channels, head.n_samples * head.n_channels * BYTES_PER_COUNT, block_id
