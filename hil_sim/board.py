"""The board on its pseudo-terminal: reads commands, takes samples when due, sends what fits."""

from __future__ import annotations

import numpy as np

from hil_sim.board_state import BoardFirmware
from hil_sim.faults import Fault, FaultSet
from hil_sim.pty_port import PtyPort
from protocols.board.codec import decode_frame
from protocols.board.records import FrameType

__all__ = ["Board"]

# The line is busy while this much waits for it.
LINK_BUFFER = 8192
# Samples taken in one step, so that a late step does not delay answers for long.
MOST_SAMPLES = 4096
LOST_SAMPLES = 100
LOST_BLOCK_FRAME = 7


class Board:
    """The shell around `BoardFirmware`.

    Parameters
    ----------
    firmware
        The device library.
    port
        The line.
    faults
        What goes wrong at present.
    rng
        For the bytes of garbage.
    """

    def __init__(
        self,
        firmware: BoardFirmware,
        port: PtyPort,
        *,
        faults: FaultSet,
        rng: np.random.Generator,
    ) -> None:
        self.firmware = firmware
        self.port = port
        self._faults = faults
        self._rng = rng
        self._unread = b""
        self._block_frames = 0
        firmware.send = self._send

    @property
    def wants_write(self) -> bool:
        """Whether to be woken when the line has room."""
        return self.port.pending > 0

    @property
    def idle(self) -> bool:
        """Whether nothing happens here unless the host asks."""
        return self.firmware.samples_due() == 0 and not self.wants_write

    def step(self) -> None:
        """Do what is to be done now; never waits."""
        if not self._unread:
            self._unread = self.port.read()
        self._answer()
        if self._faults.take(Fault.DICTIONARY_CHANGE):
            self.firmware.open_sensor(len(self.firmware.dictionary.channels) - 1)
        due = min(self.firmware.samples_due(), MOST_SAMPLES)
        if due > LOST_SAMPLES and self._faults.take(Fault.ADC_GAP):
            self.firmware.lose_samples(LOST_SAMPLES)
            due -= LOST_SAMPLES
        if due:
            self.firmware.take_samples(due)
        while self.firmware.poll():
            if not self.port.flush():
                return
        self.port.flush()

    def _answer(self) -> None:
        if self._unread:
            self._unread = self._unread[self.firmware.receive(self._unread) :]
            self.port.flush()

    def _send(self, frame: bytes) -> bool:
        """Put a frame on the line, as it is or as a fault will have it; whether there was room."""
        if self.port.pending >= LINK_BUFFER and not self.port.flush():
            return False
        if Fault.BOARD_SILENCE in self._faults or self._is_lost(frame):
            return True
        if Fault.BOARD_GARBAGE in self._faults:
            frame = self._rng.bytes(len(frame))
        self.port.queue(frame)
        return True

    def _is_lost(self, frame: bytes) -> bool:
        if Fault.BLOCK_LOSS not in self._faults:
            return False
        if decode_frame(frame[1:-1]).header.type is not FrameType.BLOCK_DATA:
            return False
        self._block_frames += 1
        return self._block_frames % LOST_BLOCK_FRAME == 0
