"""A front end as a board: its samples go through the device library, its line is in memory.

Trigger, pre-trigger, blocks held and sent again, and the counts of what was lost are the board's,
so that judge, journal and screens need not know what has sampled. The block buffer is the ring that
holds the pre-trigger.
"""

from __future__ import annotations

import os
import secrets
from dataclasses import replace
from fractions import Fraction

from armodal.daq.clock import Clock
from armodal.daq.front_end.source import SampleSource
from armodal.protocols.board.records import BoardDictionary, Channel
from armodal.protocols.c.device_board import DeviceBoard, PortingLayer
from armodal.protocols.front_end import FrontEnd

__all__ = ["FrontEndPort"]

TICK_HZ = 1_000_000
BLOCK_CAPACITY = 32 * 2**20
LINK_BYTES_PER_S = 100_000_000
PREVIEW_FRAMES = 4096
MOST_WAITING = 8 * 2**20  # bytes that nobody has read: then the board says that its line is busy


class FrontEndPort:
    """The line of a board that a front end has become; `daq.serial_port.BytePort`.

    Parameters
    ----------
    front_end
        What the front-end file says.
    source
        The device.
    clock
        The laboratory's; its microseconds are the board's ticks.
    """

    def __init__(self, front_end: FrontEnd, source: SampleSource, clock: Clock) -> None:
        self.name = front_end.name
        self._source = source
        self._clock = clock
        self._waiting = bytearray()
        self._unread = b""
        # Always readable: whoever waits for the board looks at the device in every turn.
        self._readable, self._written = os.pipe()
        os.write(self._written, b"\x00")
        self._board = DeviceBoard(
            BoardDictionary(
                board_id=f"{front_end.device}:{front_end.name}"[:32],
                firmware=source.driver[:32],
                link_bytes_per_s=LINK_BYTES_PER_S,
                block_capacity=BLOCK_CAPACITY,
                tick_hz=TICK_HZ,
                filter_group_delay_samples=front_end.filter_group_delay_samples,
                channels=_with_teds(front_end.channels, source.teds),
            ),
            session=secrets.randbits(32) | 1,
            layer=PortingLayer(
                send=self._send,
                ticks=self._ticks,
                rate_refusal=source.rate_refusal,
                start=self._start,
                stop=source.stop,
            ),
            preview_frames=PREVIEW_FRAMES,
        )

    def fileno(self) -> int:
        """Return a descriptor that can always be read."""
        return self._readable

    def read(self) -> bytes:
        """Take what the device has sampled, and return what the board sends; never waits."""
        if self._board.running:
            for chunk in self._source.read(self._clock.now_s()):
                if chunk.lost:
                    self._board.lost(chunk.lost)
                self._board.samples(chunk.counts, round(chunk.ready_s * TICK_HZ))
        self._answer()
        sent = bytes(self._waiting)
        self._waiting.clear()
        return sent

    def write(self, data: bytes) -> None:
        """Hand the host's bytes to the board."""
        self._unread += data
        self._answer()

    def close(self) -> None:
        """Let go of the device."""
        self._source.close()
        os.close(self._readable)
        os.close(self._written)

    def _answer(self) -> None:
        self._unread = self._unread[self._board.receive(self._unread) :]
        self._board.poll()

    def _send(self, frame: bytes) -> bool:
        if len(self._waiting) > MOST_WAITING:
            return False
        self._waiting += frame
        return True

    def _ticks(self) -> int:
        return round(self._clock.now_s() * TICK_HZ)

    def _start(self, rate_hz: Fraction) -> None:
        self._source.start(rate_hz, self._clock.now_s())


def _with_teds(channels: tuple[Channel, ...], teds: tuple[bytes, ...]) -> tuple[Channel, ...]:
    """Channels with the data sheets that the device has read of their sensors."""
    read = teds or (b"",) * len(channels)
    return tuple(replace(c, teds=data) for c, data in zip(channels, read, strict=True))
