"""Bytes with something wrong in them, for the board protocol's test vectors."""

from __future__ import annotations

import zlib
from typing import Any

from cobs import cobs
from support import board_examples as examples
from support.board_examples import header_of

from armodal.protocols.board import (
    MAX_PAYLOAD,
    FrameDecoder,
    FrameType,
    Overflow,
    Release,
    ReplyCode,
    Samples,
    encode_answer,
    encode_frame,
    encode_payload,
    encode_reply,
    encode_samples,
)


def sealed(body: bytes) -> bytes:
    """COBS of a body with its right CRC, whatever the body says."""
    return bytes(cobs.encode(body + zlib.crc32(body).to_bytes(4, "little")))


def invalid_frames() -> list[dict[str, str]]:
    """Stretches between delimiters that are no frames."""
    good = encode_frame(header_of(3, FrameType.STATUS, 0, Overflow.NONE))[1:-1]
    body = bytes(cobs.decode(good))[:-4]
    wrong = bytearray(cobs.decode(good))
    wrong[8] ^= 1
    big_endian = body + zlib.crc32(body).to_bytes(4, "big")
    cases = [
        ("code byte points past the end", good[:-1], "cobs"),
        ("a single code byte", b"\x05", "cobs"),
        ("an empty body", b"\x01", "short"),
        ("right CRC, header one byte short", sealed(body[:-1]), "short"),
        ("one bit of the sequence changed", bytes(cobs.encode(bytes(wrong))), "crc"),
        ("CRC in the wrong byte order", bytes(cobs.encode(big_endian)), "crc"),
        ("payload one byte too long", sealed(body + b"\x01" * (MAX_PAYLOAD + 1)), "long"),
        ("version 2", sealed(b"\x02" + body[1:]), "version"),
        ("type 0", sealed(body[:1] + b"\x00" + body[2:]), "type"),
        ("type 0x93", sealed(body[:1] + b"\x93" + body[2:]), "type"),
    ]
    return [
        {"name": name, "encoded": encoded.hex(), "reason": reason}
        for name, encoded, reason in cases
    ]


def invalid_payloads() -> list[dict[str, str]]:
    """Payloads that do not say what their type needs."""
    configuration = encode_payload(examples.CONFIGURATION)
    status = encode_answer(examples.STATUS)
    stream = encode_samples(Samples(first_sample=0, counts=examples.SMALL_COUNTS))
    ready = encode_payload(examples.BLOCK_INFO)
    cases = [
        (FrameType.CONFIGURE, configuration[:-1], "one byte short"),
        (FrameType.CONFIGURE, configuration + b"\x00", "one byte too long"),
        (FrameType.CONFIGURE, bytes(4) + configuration[4:], "rate 0"),
        (FrameType.CONFIGURE, configuration[:4] + bytes(4) + configuration[8:], "denominator 0"),
        (FrameType.CONFIGURE, configuration[:13] + b"\x02" + configuration[14:], "slope 2"),
        (FrameType.CONFIGURE_REPLY, b"", "empty"),
        (FrameType.CONFIGURE_REPLY, b"\x08\x00", "code 8"),
        (FrameType.CONFIGURE_REPLY, b"\x01\x04abc", "reason cut short"),
        (FrameType.CONFIGURE_REPLY, b"\x01\x01\xff", "reason is not UTF-8"),
        (FrameType.STATUS_REPLY, status[:-1], "one byte short"),
        (FrameType.STATUS_REPLY, status[:2] + b"\x03" + status[3:], "state 3"),
        (FrameType.STATUS_REPLY, encode_reply(ReplyCode.WRONG_SESSION), "refused, no status"),
        (FrameType.RESEND, bytes(11), "one byte short"),
        (FrameType.RELEASE, encode_payload(Release(block_id=1)) + b"\x00", "one byte too long"),
        (FrameType.BLOCK_READY, bytes(4) + ready[4:], "block id 0"),
        (FrameType.BLOCK_READY, ready[:4] + bytes(4) + ready[8:], "trigger outside the block"),
        (FrameType.STREAM, stream[:3], "prefix cut short"),
        (FrameType.STREAM, stream[:-1], "counts cut short"),
        (FrameType.STREAM, bytes(2) + stream[2:4], "no samples"),
        (FrameType.STREAM, stream[:3] + b"\x04" + stream[4:], "four bytes per count"),
        (FrameType.BLOCK_DATA, stream[:4] + bytes(4) + stream[4:], "block id 0"),
        (FrameType.HELLO_REPLY, b"\x04\x00\x00\x00", "empty fragment"),
        (FrameType.HELLO_REPLY, b"\x04\x00\x03\x00ab", "fragment past the end"),
    ]
    return [
        {
            "name": f"{kind.name}: {reason}",
            "type": kind.name,
            "payload": data.hex(),
            "reason": reason,
        }
        for kind, data, reason in cases
    ]


def streams() -> list[dict[str, Any]]:
    """Byte streams with trouble in them, and what a receiver makes of them."""
    one, two = (encode_frame(header_of(i, FrameType.STOP, 0, Overflow.NONE)) for i in (4, 5))
    no_zero_end = next(
        wire
        for wire in (
            encode_frame(
                header_of(i, FrameType.CONFIGURE_REPLY, 0, Overflow.NONE),
                encode_reply(ReplyCode.BAD_VALUE, "x" * 248),
            )
            for i in range(100)
        )
        if wire[-256] == 0xFF
    )
    cases = [
        ("two frames", one + two),
        ("delimiters shared and repeated", one[:-1] + two + bytes(5)),
        ("joined in the middle of a frame", one[10:] + two),
        ("a frame cut short by the next", one[:20] + two),
        ("noise before, between and after", b"\x07noise" + one + b"\xff\xfe\xfd" + two + b"tail"),
        ("a long stretch without delimiter", one + b"\x41" * 5000 + two),
        ("frame ends in 254 non-zero bytes", no_zero_end),
        ("the same with the code byte 01 after them", no_zero_end[:-1] + b"\x01\x00"),
    ]
    vectors = []
    for name, data in cases:
        decoder = FrameDecoder()
        sequences = [frame.header.sequence for frame in decoder.feed(data)]
        vectors.append(
            {
                "name": name,
                "bytes": data.hex(),
                "sequences": sequences,
                "bad_frames": decoder.bad_frames,
                "garbage_bytes": decoder.garbage_bytes,
            }
        )
    return vectors
