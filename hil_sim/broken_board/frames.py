"""Faults of frames, sample counts and clocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from armodal.hil_sim.broken_board.altered import BrokenBoard, altered, decoded, stretch
from armodal.protocols.board.messages import (
    decode_payload,
    encode_payload,
)
from armodal.protocols.board.records import (
    BlockInfo,
    Configuration,
    Frame,
    FrameType,
)
from armodal.protocols.errors import FrameError

__all__ = [
    "FastClock",
    "HashLost",
    "Renumbered",
    "SilentSkip",
    "SlowSamples",
    "StuckSequence",
    "TicksBackwards",
    "TwiceSent",
    "WrongCrc",
    "WrongHash",
]


class WrongCrc(BrokenBoard):
    """Every fortieth frame has a wrong bit."""

    def __init__(self) -> None:
        super().__init__()
        self._n = 0

    def wire(self, frame: Frame) -> bytes:
        """Compose the bytes of a frame."""
        self._n += 1
        wire = bytearray(super().wire(frame))
        if self._n % 40 == 0:
            wire[-3] ^= 0x01 if wire[-3] != 0x01 else 0x02
        return bytes(wire)


class Renumbered(BrokenBoard):
    """A board that numbers its frames itself, for faults that leave frames out or add some."""

    def __init__(self) -> None:
        super().__init__()
        self._next: int | None = None

    def wire(self, frame: Frame) -> bytes:
        """Compose the bytes of a frame."""
        number = frame.header.sequence if self._next is None else self._next
        self._next = (number + 1) & 0xFFFFFFFF
        return super().wire(altered(frame, sequence=number))


class StuckSequence(BrokenBoard):
    """Every twentieth frame repeats the number of the one before."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        number = frame.header.sequence
        yield altered(frame, sequence=number - (number % 20 == 19))


class WrongHash(BrokenBoard):
    """The header's dictionary hash is not that of the dictionary."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        yield altered(frame, dictionary_hash=frame.header.dictionary_hash ^ 0x0100)


class HashLost(BrokenBoard):
    """STREAM frames carry no dictionary hash."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        is_stream = frame.header.type is FrameType.STREAM
        yield altered(frame, dictionary_hash=0) if is_stream else frame


class SilentSkip(Renumbered):
    """Every thirtieth STREAM frame is left out, and nothing says so."""

    def __init__(self) -> None:
        super().__init__()
        self._n = 0

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        self._n += frame.header.type is FrameType.STREAM
        if frame.header.type is not FrameType.STREAM or self._n % 30:
            yield frame


class TwiceSent(Renumbered):
    """Every thirtieth STREAM frame is sent twice, as two frames."""

    def __init__(self) -> None:
        super().__init__()
        self._n = 0

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        yield frame
        self._n += frame.header.type is FrameType.STREAM
        if frame.header.type is FrameType.STREAM and self._n % 30 == 0:
            yield frame


class SlowSamples(BrokenBoard):
    """The converter runs a few per cent slower than the board was told and says."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        if frame is None or frame.header.type is not FrameType.CONFIGURE:
            return piece
        try:
            wanted = decode_payload(Configuration, frame.payload)
        except FrameError:
            return piece
        divisor = 51_200 / wanted.rate_hz
        if divisor.denominator != 1:
            return piece
        slower = replace(wanted, rate_hz=51_200 / (divisor + 1))
        return stretch(altered(frame, encode_payload(slower)))


class FastClock(BrokenBoard):
    """Ticks run half a per cent fast."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        ticks = frame.header.ticks + frame.header.ticks // 200
        if frame.header.type is FrameType.BLOCK_READY:
            info = decode_payload(BlockInfo, frame.payload)
            info = replace(info, trigger_ticks=info.trigger_ticks + info.trigger_ticks // 200)
            yield altered(frame, encode_payload(info), ticks=ticks)
        else:
            yield altered(frame, ticks=ticks)


class TicksBackwards(BrokenBoard):
    """The tick counter is a 16-bit timer that was never extended in software."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        yield altered(frame, ticks=frame.header.ticks & 0xFFFF)
