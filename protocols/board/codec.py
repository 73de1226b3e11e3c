"""Frames on the wire: `00 | COBS(header, payload, CRC-32) | 00`.

The bytes are specified in `docs/board-protocol.md`, sections 2 and 3.
"""

from __future__ import annotations

import struct
import zlib

from cobs import cobs

from armodal.protocols.board.layout import encode, layout_of
from armodal.protocols.board.records import (
    PROTOCOL_VERSION,
    Frame,
    FrameType,
    Header,
    Overflow,
)
from armodal.protocols.errors import FrameError

__all__ = [
    "HEADER_SIZE",
    "MAX_PAYLOAD",
    "PROTOCOL_VERSION",
    "FrameDecoder",
    "decode_frame",
    "encode_frame",
    "wire_size",
]

MAX_PAYLOAD = 2048

_HEADER = layout_of(Header)
_CRC = struct.Struct("<I")
HEADER_SIZE = _HEADER.size
_OVERHEAD = HEADER_SIZE + _CRC.size
_MAX_ENCODED = cobs.max_encoded_length(_OVERHEAD + MAX_PAYLOAD)

_TYPES = {int(kind): kind for kind in FrameType}
_OVERFLOW_MASK = int(Overflow.STREAM | Overflow.BLOCK | Overflow.ADC)
_OVERFLOWS = tuple(Overflow(bits) for bits in range(_OVERFLOW_MASK + 1))


def encode_frame(header: Header, payload: bytes = b"") -> bytes:
    """Compose a frame with both its delimiters.

    Parameters
    ----------
    header
        Its fields must fit their widths on the wire.
    payload
        At most `MAX_PAYLOAD` bytes.

    Raises
    ------
    FrameError
        If a field does not fit or the payload is too long.
    """
    if len(payload) > MAX_PAYLOAD:
        raise FrameError(
            f"a payload holds at most {MAX_PAYLOAD} bytes, got {len(payload)}: "
            "split it over several frames"
        )
    body = encode(header, "header") + payload
    encoded: bytes = cobs.encode(body + _CRC.pack(zlib.crc32(body)))
    return b"\x00" + encoded + b"\x00"


def decode_frame(encoded: bytes) -> Frame:
    """Decode what stood between two delimiters.

    Parameters
    ----------
    encoded
        COBS bytes without the `00` on either side.

    Raises
    ------
    FrameError
        If the bytes are not a frame of this protocol version.
    """
    if len(encoded) > _MAX_ENCODED:
        raise FrameError(f"a frame has at most {_MAX_ENCODED} bytes, got {len(encoded)}")
    try:
        body: bytes = cobs.decode(encoded)
    except cobs.DecodeError as error:
        raise FrameError(f"not COBS: {error}") from error
    end = len(body) - _CRC.size
    if end < HEADER_SIZE:
        raise FrameError(f"a frame decodes to at least {_OVERHEAD} bytes, got {len(body)}")
    if end - HEADER_SIZE > MAX_PAYLOAD:
        raise FrameError(f"a payload holds at most {MAX_PAYLOAD} bytes, got {end - HEADER_SIZE}")
    (crc,) = _CRC.unpack_from(body, end)
    computed = zlib.crc32(memoryview(body)[:end])
    if crc != computed:
        raise FrameError(f"CRC-32 is 0x{computed:08x}, the frame says 0x{crc:08x}")
    return _frame_of(body, end)


def _frame_of(body: bytes, end: int) -> Frame:
    values = _HEADER.form.unpack_from(body)
    version, number = values[:2]
    if version != PROTOCOL_VERSION:
        raise FrameError(
            f"the frame has protocol version {version}, this program speaks {PROTOCOL_VERSION}: "
            "update the older side"
        )
    kind = _TYPES.get(number)
    if kind is None:
        raise FrameError(f"frame type 0x{number:02x} is not one of version {PROTOCOL_VERSION}")
    # Field by field rather than by `decode`: this is done a thousand times a second.
    header = Header(
        type=kind,
        dictionary_hash=values[2],
        session=values[3],
        sequence=values[4],
        overflow=_OVERFLOWS[values[5] & _OVERFLOW_MASK],
        tag=values[6],
        first_sample=values[7],
        ticks=values[8],
    )
    return Frame(header=header, payload=body[HEADER_SIZE:end])


def wire_size(payload_size: int) -> int:
    """Largest number of bytes a frame with this payload takes on the wire, delimiters included."""
    return int(cobs.max_encoded_length(_OVERHEAD + payload_size)) + 2


class FrameDecoder:
    """Cut a byte stream into frames, whatever the bytes are.

    A stretch between two delimiters that is no frame is counted and skipped, and the next
    delimiter is the next chance. At most one longest frame is kept between calls.

    Attributes
    ----------
    frames : int
        Valid frames so far.
    bad_frames : int
        Stretches between delimiters that were no valid frame.
    garbage_bytes : int
        Bytes in those stretches.
    last_error : str
        Why the last of them was refused; empty while there was none.
    """

    def __init__(self) -> None:
        self.frames = 0
        self.bad_frames = 0
        self.garbage_bytes = 0
        self.last_error = ""
        self._tail = b""
        self._skipping = False

    def feed(self, data: bytes) -> list[Frame]:
        """Take in bytes as they came and return the frames they completed."""
        pieces = (self._tail + data).split(b"\x00")
        self._tail = pieces.pop()
        if self._skipping and pieces:
            self.garbage_bytes += len(pieces.pop(0))
            self._skipping = False
        frames: list[Frame] = []
        for piece in pieces:
            if not piece:
                continue
            try:
                frames.append(decode_frame(piece))
            except FrameError as error:
                self._refuse(piece, str(error))
        self.frames += len(frames)
        if len(self._tail) > _MAX_ENCODED or self._skipping:
            self._skip_tail()
        return frames

    def _refuse(self, piece: bytes, reason: str) -> None:
        self.bad_frames += 1
        self.garbage_bytes += len(piece)
        self.last_error = reason

    def _skip_tail(self) -> None:
        if self._skipping:
            self.garbage_bytes += len(self._tail)
        else:
            self._refuse(self._tail, f"no delimiter within {_MAX_ENCODED} bytes")
            self._skipping = True
        self._tail = b""
