"""What an acquisition needs of the computer it runs on, so that a test may give it another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Protocol

from armodal.daq.can_listener import CanSource, open_can
from armodal.daq.clock import Clock, SystemClock
from armodal.daq.events import Event
from armodal.daq.front_end import is_front_end, open_front_end
from armodal.daq.outbox import Outbox
from armodal.daq.serial_port import BytePort, SerialPort
from armodal.daq.settings import AcquisitionSettings

__all__ = ["EventQueue", "Surroundings", "open_board"]


class EventQueue(Protocol):
    """Where events go; `daq.outbox.Outbox` is one."""

    previews_dropped: int

    def put(self, event: Event) -> None:
        """Take an event to be sent; returns at once."""

    def finish(self, timeout_s: float) -> bool:
        """Send what is queued, for at most so many wall seconds; False if some was left."""


def open_board(settings: AcquisitionSettings) -> BytePort:
    """Open the board's line: a serial port, or a front end that becomes a board."""
    if is_front_end(settings.board_port):
        return open_front_end(Path(settings.board_port), SystemClock(settings.time_scale))
    return SerialPort(settings.board_port, baud=settings.board_baud)


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """Clock, lines and the way to the listener.

    clock : time, and waiting for bytes
    open_board : opens the board's line
    open_can : opens the bus
    make_outbox : makes the queue of events in front of the listener's connection
    """

    clock: Clock
    open_board: Callable[[AcquisitionSettings], BytePort]
    open_can: Callable[[AcquisitionSettings, int], CanSource]
    make_outbox: Callable[[Connection[Any, Any]], EventQueue]

    @classmethod
    def of(cls, settings: AcquisitionSettings) -> Surroundings:
        """Return those of a real laboratory, or one on this machine's pseudo-terminals."""
        return cls(
            clock=SystemClock(settings.time_scale),
            open_board=open_board,
            open_can=lambda s, bitrate: open_can(s.can_channel, bitrate),
            make_outbox=Outbox,
        )
