"""The channel dictionary: how a board describes itself, and how it travels in fragments.

The bytes are specified in `docs/board-protocol.md`, section 5.
"""

from __future__ import annotations

import datetime as dt
import math
import struct
import unicodedata
import zlib
from collections.abc import Sequence

from armodal.protocols.board.binary import Reader, pack, text_field
from armodal.protocols.board.layout import decode_head, encode
from armodal.protocols.board.records import BoardDictionary, Channel, FragmentHead, IepeState
from armodal.protocols.errors import FrameError

__all__ = [
    "MAX_DICTIONARY",
    "decode_dictionary",
    "dictionary_hash",
    "encode_dictionary",
    "hello_fragments",
    "join_hello",
]

LAYOUT_VERSION = 1
MAX_CHANNELS = 32
MAX_DICTIONARY = 0xFFFF
FRAGMENT_SIZE = 512

_HEAD = struct.Struct("<BBIIId")
_CHANNEL = struct.Struct("<Bddd")
_TEDS_LENGTH = struct.Struct("<H")


def encode_dictionary(dictionary: BoardDictionary) -> bytes:
    """Lay out a dictionary as the constant array a board keeps.

    Raises
    ------
    FrameError
        If a value is impossible or the whole is longer than `MAX_DICTIONARY` bytes.
    """
    _check(dictionary)
    parts = [
        pack(
            _HEAD,
            "dictionary head",
            LAYOUT_VERSION,
            len(dictionary.channels),
            dictionary.link_bytes_per_s,
            dictionary.block_capacity,
            dictionary.tick_hz,
            dictionary.filter_group_delay_samples,
        ),
        text_field(dictionary.board_id, "board id"),
        text_field(dictionary.firmware, "firmware version"),
    ]
    for channel in dictionary.channels:
        parts += _channel_parts(channel)
    encoded = b"".join(parts)
    if len(encoded) > MAX_DICTIONARY:
        raise FrameError(
            f"a dictionary takes at most {MAX_DICTIONARY} bytes, got {len(encoded)}: shorten TEDS"
        )
    return encoded


def _channel_parts(channel: Channel) -> list[bytes]:
    what = f"channel {channel.name}"
    return [
        pack(_CHANNEL, what, channel.iepe, channel.scale, channel.full_scale, channel.highpass_hz),
        text_field(channel.name, f"{what}: name"),
        text_field(channel.quantity, f"{what}: quantity"),
        text_field(channel.unit, f"{what}: unit"),
        text_field(channel.serial_number, f"{what}: serial number"),
        text_field(channel.calibration_date, f"{what}: calibration date"),
        pack(_TEDS_LENGTH, f"{what}: TEDS length", len(channel.teds)),
        channel.teds,
    ]


def decode_dictionary(data: bytes) -> BoardDictionary:
    """Read a dictionary.

    Raises
    ------
    FrameError
        If the bytes are no dictionary of this layout or say something impossible.
    """
    reader = Reader(data, "dictionary")
    layout, n_channels, link, capacity, tick_hz, delay = reader.unpack(_HEAD)
    if layout != LAYOUT_VERSION:
        raise FrameError(f"dictionary layout {LAYOUT_VERSION} wanted, got {layout}")
    board_id, firmware = reader.text(), reader.text()
    dictionary = BoardDictionary(
        board_id=board_id,
        firmware=firmware,
        link_bytes_per_s=link,
        block_capacity=capacity,
        tick_hz=tick_hz,
        filter_group_delay_samples=delay,
        channels=tuple(_read_channel(reader) for _ in range(n_channels)),
    )
    reader.finish()
    _check(dictionary)
    return dictionary


def _read_channel(reader: Reader) -> Channel:
    iepe, scale, full_scale, highpass_hz = reader.unpack(_CHANNEL)
    name, quantity, unit, serial_number, date = (reader.text() for _ in range(5))
    (teds_length,) = reader.unpack(_TEDS_LENGTH)
    if iepe not in set(IepeState):
        raise FrameError(f"channel {name!r}: IEPE state 0...3 wanted, got {iepe}")
    return Channel(
        name=name,
        quantity=quantity,
        unit=unit,
        scale=scale,
        full_scale=full_scale,
        iepe=IepeState(iepe),
        highpass_hz=highpass_hz,
        serial_number=serial_number,
        calibration_date=date,
        teds=reader.take(teds_length),
    )


def _check(dictionary: BoardDictionary) -> None:
    _check_text(dictionary.board_id, "board id")
    _check_text(dictionary.firmware, "firmware version")
    for index, channel in enumerate(dictionary.channels):
        for field in ("name", "quantity", "unit", "serial_number", "calibration_date"):
            _check_text(getattr(channel, field), f"channel {index}: {field.replace('_', ' ')}")
    count = len(dictionary.channels)
    if not 1 <= count <= MAX_CHANNELS:
        raise FrameError(f"a board has 1...{MAX_CHANNELS} channels, got {count}")
    names = [channel.name for channel in dictionary.channels]
    if len(set(names)) != count or "" in names:
        raise FrameError(f"channel names must be given and differ, got {names}")
    for field in ("link_bytes_per_s", "block_capacity", "tick_hz"):
        if getattr(dictionary, field) < 1:
            raise FrameError(f"{field} must be positive, got {getattr(dictionary, field)}")
    delay = dictionary.filter_group_delay_samples
    if not (math.isfinite(delay) and delay >= 0):
        raise FrameError(f"the filter group delay must be at least 0 samples, got {delay}")
    for channel in dictionary.channels:
        _check_channel(channel)


def _check_text(text: str, what: str) -> None:
    if any(unicodedata.category(character) == "Cc" for character in text):
        raise FrameError(
            f"{what}: text without control characters wanted, got {text!r}: correct the board's "
            "dictionary"
        )


def _check_channel(channel: Channel) -> None:
    what = f"channel {channel.name}"
    if not channel.quantity or not channel.unit:
        raise FrameError(f"{what}: quantity and unit must be given")
    if not math.isfinite(channel.scale) or channel.scale == 0:
        raise FrameError(f"{what}: scale must be finite and not 0, got {channel.scale}")
    if not (math.isfinite(channel.full_scale) and channel.full_scale > 0):
        raise FrameError(f"{what}: full scale must be positive, got {channel.full_scale}")
    if not (math.isfinite(channel.highpass_hz) and channel.highpass_hz >= 0):
        raise FrameError(f"{what}: high-pass must be at least 0 Hz, got {channel.highpass_hz}")
    if channel.calibration_date and not _is_date(channel.calibration_date):
        raise FrameError(
            f"{what}: calibration date YYYY-MM-DD wanted, got {channel.calibration_date!r}"
        )


def _is_date(text: str) -> bool:
    try:
        return dt.date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def dictionary_hash(encoded: bytes) -> int:
    """Low 16 bits of the CRC-32 of a dictionary's bytes; every frame of the board carries it."""
    return zlib.crc32(encoded) & 0xFFFF


def hello_fragments(encoded: bytes) -> list[bytes]:
    """HELLO_REPLY payloads that together carry a dictionary, in order."""
    if not 1 <= len(encoded) <= MAX_DICTIONARY:
        raise FrameError(f"a dictionary takes 1...{MAX_DICTIONARY} bytes, got {len(encoded)}")
    return [
        encode(FragmentHead(total=len(encoded), offset=offset))
        + encoded[offset : offset + FRAGMENT_SIZE]
        for offset in range(0, len(encoded), FRAGMENT_SIZE)
    ]


def join_hello(payloads: Sequence[bytes]) -> bytes | None:
    """Join HELLO_REPLY payloads, in any order, with repetitions.

    Returns
    -------
    bytes or None
        The dictionary's bytes, or None while some are missing.

    Raises
    ------
    FrameError
        If a payload is no fragment or two of them disagree.
    """
    pieces: dict[int, bytes] = {}
    total: int | None = None
    for payload in payloads:
        head, at = decode_head(FragmentHead, payload, "HELLO_REPLY")
        length, offset, piece = head.total, head.offset, payload[at:]
        if not piece or offset + len(piece) > length:
            raise FrameError(
                f"HELLO_REPLY: {len(piece)} bytes at {offset} do not lie in a "
                f"dictionary of {length} bytes"
            )
        if total not in (None, length) or pieces.setdefault(offset, piece) != piece:
            raise FrameError("HELLO_REPLY: two fragments disagree: send HELLO again")
        total = length
    joined = b""
    for offset, piece in sorted(pieces.items()):
        if offset < len(joined):
            raise FrameError("HELLO_REPLY: two fragments overlap: send HELLO again")
        if offset > len(joined):
            return None
        joined += piece
    return joined if len(joined) == total else None
