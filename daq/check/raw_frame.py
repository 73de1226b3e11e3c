"""Frames as they came, of any version and any type: a check must see what a host would drop.

`docs/board-protocol.md`, sections 2 and 3.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass

from cobs import cobs

from armodal.protocols.board.codec import HEADER_SIZE, MAX_PAYLOAD, PROTOCOL_VERSION
from armodal.protocols.board.records import Frame, FrameType, Header, Overflow
from armodal.protocols.errors import FrameError

__all__ = ["RawDecoder", "RawFrame", "encode_raw"]

_HEADER = struct.Struct("<BBHIIHHQQ")
_CRC_SIZE = 4
LONGEST_STRETCH = cobs.max_encoded_length(HEADER_SIZE + MAX_PAYLOAD + _CRC_SIZE)


@dataclass(frozen=True, slots=True, kw_only=True)
class RawFrame:
    """A frame whose CRC is right; nothing else of it has been judged."""

    version: int
    type: int
    dictionary_hash: int
    session: int
    sequence: int
    overflow: int
    tag: int
    first_sample: int
    ticks: int
    payload: bytes
    received_s: float  # lab time at which its bytes were read

    def frame(self) -> Frame:
        """Return it as the frame of this protocol version; FrameError if it is none."""
        if self.version != PROTOCOL_VERSION or self.type not in set(FrameType):
            raise FrameError(f"version {self.version}, type 0x{self.type:02x}")
        header = Header(
            type=FrameType(self.type),
            session=self.session,
            sequence=self.sequence,
            dictionary_hash=self.dictionary_hash,
            overflow=Overflow(self.overflow & 7),
            tag=self.tag,
            first_sample=self.first_sample,
            ticks=self.ticks,
        )
        return Frame(header=header, payload=self.payload)


def encode_raw(
    kind: int,
    payload: bytes = b"",
    *,
    session: int,
    sequence: int,
    tag: int,
    version: int = PROTOCOL_VERSION,
    crc_error: int = 0,
) -> bytes:
    """Compose a command of any type and version, with both delimiters.

    The CRC-32 is altered by the bits of `crc_error`.
    """
    body = _HEADER.pack(version, kind, 0, session, sequence, 0, tag, 0, 0) + payload
    encoded: bytes = cobs.encode(body + struct.pack("<I", zlib.crc32(body) ^ crc_error))
    return b"\x00" + encoded + b"\x00"


class RawDecoder:
    """Cut bytes into frames.

    Attributes
    ----------
    faults : list of str
        Of every stretch that was no frame, why.
    """

    def __init__(self) -> None:
        self.faults: list[str] = []
        self._tail = b""

    def feed(self, data: bytes, now_s: float) -> list[RawFrame]:
        """Take bytes as they came and return the frames they completed."""
        pieces = (self._tail + data).split(b"\x00")
        self._tail = pieces.pop()
        if len(self._tail) > LONGEST_STRETCH:
            self.faults.append(f"no delimiter within {LONGEST_STRETCH} bytes")
            self._tail = b""
        frames = []
        for piece in pieces:
            if not piece:
                continue
            try:
                frames.append(_decode(piece, now_s))
            except FrameError as error:
                self.faults.append(str(error))
        return frames


def _decode(piece: bytes, now_s: float) -> RawFrame:
    try:
        body: bytes = cobs.decode(piece)
    except cobs.DecodeError as error:
        raise FrameError(f"not COBS: {error}") from error
    end = len(body) - _CRC_SIZE
    if not HEADER_SIZE <= end <= HEADER_SIZE + MAX_PAYLOAD:
        raise FrameError(f"{len(body)} bytes decoded are too few or too many for a frame")
    said = int.from_bytes(body[end:], "little")
    computed = zlib.crc32(memoryview(body)[:end])
    if said != computed:
        raise FrameError(f"CRC-32 is {computed:08x}, the frame says {said:08x}")
    version, kind, dictionary_hash, session, sequence, overflow, tag, first, ticks = (
        _HEADER.unpack_from(body)
    )
    return RawFrame(
        version=version,
        type=kind,
        dictionary_hash=dictionary_hash,
        session=session,
        sequence=sequence,
        overflow=overflow,
        tag=tag,
        first_sample=first,
        ticks=ticks,
        payload=body[HEADER_SIZE:end],
        received_s=now_s,
    )
