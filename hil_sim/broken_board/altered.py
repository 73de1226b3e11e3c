"""A board whose frames are altered on the wire; this one leaves them as they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from armodal.protocols.board.codec import decode_frame, encode_frame
from armodal.protocols.board.records import Frame
from armodal.protocols.errors import FrameError

__all__ = ["BrokenBoard", "altered", "decoded", "stretch"]

LONGEST_KEPT = 4096  # of the host's bytes without a delimiter; no frame is as long


class BrokenBoard:
    """A board without a fault; the faults override one method each.

    Subclasses get whole frames of the board in `frame`, which returns the frames sent in their
    place, and stretches of the host in `command`, which returns the stretch the board gets.
    """

    def __init__(self) -> None:
        self._tail = b""
        self._host_tail = b""

    def to_host(self, data: bytes) -> bytes:
        """Alter the board's bytes."""
        pieces = (self._tail + data).split(b"\x00")
        self._tail = pieces.pop()
        return b"".join(self._altered(piece) for piece in pieces if piece)

    def _altered(self, piece: bytes) -> bytes:
        try:
            frame = decode_frame(piece)
        except FrameError:
            return b"\x00" + piece + b"\x00"
        return b"".join(self.wire(sent) for sent in self.frame(frame))

    def to_device(self, data: bytes) -> bytes:
        """Alter the host's bytes."""
        pieces = (self._host_tail + data).split(b"\x00")
        self._host_tail = pieces.pop()
        if len(self._host_tail) > LONGEST_KEPT:
            # Longer than any frame: let it go on its way, it is garbage in any case.
            pieces.append(self._host_tail)
            self._host_tail = b""
        kept = [self.command(piece) for piece in pieces]
        return b"".join(b"\x00" + piece + b"\x00" for piece in kept if piece)

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Return the frames that are sent for one of the board."""
        yield frame

    def wire(self, frame: Frame) -> bytes:
        """Return the bytes of a frame."""
        return encode_frame(frame.header, frame.payload)

    def command(self, piece: bytes) -> bytes:
        """Return what the board gets for a stretch of the host, b"" for nothing."""
        return piece


def altered(frame: Frame, payload: bytes | None = None, **changes: Any) -> Frame:
    """Return a frame with another payload or other header fields."""
    header = replace(frame.header, **changes)
    return Frame(header=header, payload=frame.payload if payload is None else payload)


def decoded(piece: bytes) -> Frame | None:
    """Return the host's frame in a stretch, None if it is none."""
    try:
        return decode_frame(piece)
    except FrameError:
        return None


def stretch(frame: Frame) -> bytes:
    """Return what stands between the delimiters of a frame."""
    return encode_frame(frame.header, frame.payload)[1:-1]
