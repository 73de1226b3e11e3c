"""Faults of triggers, blocks and what is owned up to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from armodal.hil_sim.broken_board.altered import BrokenBoard, altered, decoded, stretch
from armodal.protocols.board.messages import (
    decode_answer,
    decode_payload,
    decode_samples,
    encode_answer,
    encode_payload,
    encode_samples,
)
from armodal.protocols.board.records import (
    BlockInfo,
    BoardStatus,
    Frame,
    FrameType,
    Overflow,
)

__all__ = [
    "HalfCounted",
    "LatePretrigger",
    "LateTrigger",
    "NoCounts",
    "NoFlags",
    "OtherResend",
    "WrongSlope",
]


class LatePretrigger(BrokenBoard):
    """Blocks are announced to begin three samples later than they should."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is FrameType.BLOCK_READY:
            info = decode_payload(BlockInfo, frame.payload)
            later = replace(info, first_sample=info.first_sample + 3)
            yield altered(frame, encode_payload(later))
        elif frame.header.type is FrameType.BLOCK_DATA:
            yield altered(frame, first_sample=frame.header.first_sample + 3)
        else:
            yield frame


class LateTrigger(BrokenBoard):
    """The trigger is reported two samples after it happened."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is FrameType.BLOCK_READY:
            info = decode_payload(BlockInfo, frame.payload)
            later = replace(info, trigger_sample=info.trigger_sample + 2)
            yield altered(frame, encode_payload(later))
        else:
            yield frame


class WrongSlope(BrokenBoard):
    """The slope asked for is not looked at."""

    def command(self, piece: bytes) -> bytes:
        """Alter a stretch of the host."""
        frame = decoded(piece)
        if frame is None or frame.header.type is not FrameType.CONFIGURE:
            return piece
        payload = frame.payload
        rising = payload[:13] + (b"\x00" if payload[13:14] in b"\x00\x01" else payload[13:14])
        return stretch(altered(frame, rising + payload[14:]))


class OtherResend(BrokenBoard):
    """What is sent of a block a second time is one count too high."""

    def __init__(self) -> None:
        super().__init__()
        self._seen: set[tuple[int, int]] = set()

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is FrameType.BLOCK_DATA:
            samples = decode_samples(frame)
            key = (samples.block_id or 0, samples.first_sample)
            if key in self._seen:
                yield altered(frame, encode_samples(replace(samples, counts=samples.counts + 1)))
                return
            self._seen.add(key)
        yield frame


class NoFlags(BrokenBoard):
    """The overflow flags are never set."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        yield altered(frame, overflow=Overflow.NONE)


class NoCounts(BrokenBoard):
    """STATUS always says that nothing was lost."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is FrameType.STATUS_REPLY and frame.payload[:1] == b"\x00":
            status = decode_answer(BoardStatus, frame.payload)
            clean = replace(status, stream_samples_dropped=0, triggers_missed=0, adc_overruns=0)
            yield altered(frame, encode_answer(clean))
        else:
            yield frame


class HalfCounted(BrokenBoard):
    """Of the samples dropped from the preview, half are counted."""

    def frame(self, frame: Frame) -> Iterator[Frame]:
        """Alter a frame of the board."""
        if frame.header.type is FrameType.STATUS_REPLY and frame.payload[:1] == b"\x00":
            status = decode_answer(BoardStatus, frame.payload)
            half = replace(status, stream_samples_dropped=status.stream_samples_dropped // 2)
            yield altered(frame, encode_answer(half))
        else:
            yield frame
