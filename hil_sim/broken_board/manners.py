"""Faults of the conversation."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import replace

from cobs import cobs

from armodal.hil_sim.broken_board.altered import BrokenBoard, altered, decoded, stretch
from armodal.protocols.board.codec import HEADER_SIZE, PROTOCOL_VERSION
from armodal.protocols.board.messages import (
    decode_dictionary,
    decode_reply,
    dictionary_hash,
    encode_dictionary,
    encode_reply,
    hello_fragments,
    join_hello,
)
from armodal.protocols.board.records import Frame, FrameType, Header, ReplyCode

__all__ = [
    "AnySession",
    "CutsLongCommands",
    "DeafToMalformed",
    "DeafToOtherVersions",
    "DeafToUnknown",
    "DiesOnGarbage",
    "ForgetsOnReconnect",
    "NewSession",
    "ObeysTornFrames",
    "RefusesNothing",
    "RefusesWithoutReason",
    "ScaleInAnotherUnit",
]

CRC_SIZE = 4
LONGEST_COMMAND = 67  # `docs/board-protocol.md`, section 2, both delimiters included
LONGEST_STRETCH = 2093
CONFIGURE_BYTES = 28  # section 6


class DiesOnGarbage(BrokenBoard):
    """After a stretch longer than a frame the board never answers again."""

    def __init__(self) -> None:
        super().__init__()
        self._dead = False

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if not self._dead:
            yield frame

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        self._dead = self._dead or len(piece) > LONGEST_STRETCH
        return piece


class ObeysTornFrames(BrokenBoard):
    """Commands are carried out whatever their CRC says."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        try:
            body: bytes = cobs.decode(piece)
        except cobs.DecodeError:
            return piece
        if len(body) < HEADER_SIZE + CRC_SIZE or len(piece) > LONGEST_COMMAND:
            return piece
        right = body[:-CRC_SIZE] + zlib.crc32(body[:-CRC_SIZE]).to_bytes(CRC_SIZE, "little")
        mended: bytes = cobs.encode(right)
        return mended


class NewSession(BrokenBoard):
    """Every HELLO begins a session of its own."""

    def __init__(self) -> None:
        super().__init__()
        self._true = 0
        self._shift = 0

    def hello(self, _header: Header) -> None:
        """Take note of a HELLO."""
        self._shift += 1

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        self._true = frame.header.session
        yield altered(frame, session=(frame.header.session + self._shift) & 0xFFFFFFFF)

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        if frame is None:
            return piece
        if frame.header.type is FrameType.HELLO:
            self.hello(frame.header)
        session = frame.header.session
        if session == 0 or (session - self._shift) & 0xFFFFFFFF != self._true:
            return piece
        return stretch(altered(frame, session=self._true))


class ForgetsOnReconnect(NewSession):
    """A host that begins to count its frames anew finds a new session."""

    def hello(self, header: Header) -> None:
        """Take note of a HELLO."""
        self._shift += header.sequence == 0


class RefusesNothing(BrokenBoard):
    """CONFIGURE is always answered OK."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        is_reply = frame.header.type is FrameType.CONFIGURE_REPLY
        yield altered(frame, encode_reply(ReplyCode.OK)) if is_reply else frame


class RefusesWithoutReason(BrokenBoard):
    """Refusals carry no reason."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        kind = frame.header.type
        if FrameType.HELLO_REPLY < kind < FrameType.STREAM and kind is not FrameType.STATUS_REPLY:
            yield altered(frame, encode_reply(decode_reply(frame.payload)[0]))
        else:
            yield frame


class DeafToMalformed(BrokenBoard):
    """A CONFIGURE that is too short is not answered."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        if frame is None or frame.header.type is not FrameType.CONFIGURE:
            return piece
        return piece if len(frame.payload) >= CONFIGURE_BYTES else b""


class CutsLongCommands(BrokenBoard):
    """A CONFIGURE that is too long is cut to its length and obeyed."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        if frame is None or frame.header.type is not FrameType.CONFIGURE:
            return piece
        return stretch(altered(frame, frame.payload[:CONFIGURE_BYTES]))


class DeafToUnknown(BrokenBoard):
    """Commands of an unknown type are not answered."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        return piece if decoded(piece) is not None or len(piece) > LONGEST_COMMAND else b""


class DeafToOtherVersions(BrokenBoard):
    """Frames of another protocol version are dropped, HELLO too."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        try:
            body: bytes = cobs.decode(piece)
        except cobs.DecodeError:
            return piece
        return piece if body[:1] == bytes([PROTOCOL_VERSION]) else b""


class AnySession(BrokenBoard):
    """Commands are carried out whatever session they name."""

    def __init__(self) -> None:
        super().__init__()
        self._session = 0

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        self._session = frame.header.session
        yield frame

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        return piece if frame is None else stretch(altered(frame, session=self._session))


class ScaleInAnotherUnit(BrokenBoard):
    """The dictionary gives scales in thousandths of the unit it names."""

    def __init__(self) -> None:
        super().__init__()
        self._fragments: list[bytes] = []
        self._hash: int | None = None

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is not FrameType.HELLO_REPLY:
            yield frame if self._hash is None else altered(frame, dictionary_hash=self._hash)
            return
        self._fragments.append(frame.payload)
        data = join_hello(self._fragments)
        if data is None:
            return
        self._fragments = []
        truth = decode_dictionary(data)
        channels = tuple(replace(c, scale=1000.0 * c.scale) for c in truth.channels)
        lie = encode_dictionary(replace(truth, channels=channels))
        self._hash = dictionary_hash(lie)
        for part in hello_fragments(lie):
            yield altered(frame, part, dictionary_hash=self._hash)
