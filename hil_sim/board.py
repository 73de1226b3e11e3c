"""The board on its pseudo-terminal: reads commands, takes samples when due, sends what fits."""

from __future__ import annotations

import numpy as np

from hil_sim.board_state import BoardFirmware
from hil_sim.faults import Fault, FaultSet
from hil_sim.pty_port import PtyPort
from protocols.board.codec import FrameDecoder, encode_frame
from protocols.board.messages import encode_block_info, encode_samples
from protocols.board.records import BlockInfo, FrameType, Header, Samples

__all__ = ["Board"]

# Blocks and preview are composed only while less than this waits for the line.
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
        The state machine.
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
        self._decoder = FrameDecoder()
        self._block_frames = 0

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
        self._answer()
        if self._faults.take(Fault.DICTIONARY_CHANGE):
            self.firmware.open_sensor(len(self.firmware.dictionary.channels) - 1)
        due = min(self.firmware.samples_due(), MOST_SAMPLES)
        if due > LOST_SAMPLES and self._faults.take(Fault.ADC_GAP):
            self.firmware.lose_samples(LOST_SAMPLES)
            due -= LOST_SAMPLES
        if due:
            self.firmware.take_samples(due)
        self._send_data()

    def _answer(self) -> None:
        data = self.port.read()
        if not data:
            return
        for frame in self._decoder.feed(data):
            for kind, payload in self.firmware.handle(frame):
                self._queue(self.firmware.header(kind, tag=frame.header.tag), payload)
            self.port.flush()

    def _send_data(self) -> None:
        while True:
            while self.port.pending < LINK_BUFFER:
                data = self.firmware.next_data()
                if data is None:
                    break
                self._queue_data(data)
            if not self.port.flush() or not self.firmware.has_data:
                return

    def _queue_data(self, data: BlockInfo | Samples) -> None:
        if isinstance(data, BlockInfo):
            self._queue(self.firmware.header(FrameType.BLOCK_READY), encode_block_info(data))
            return
        kind = FrameType.STREAM if data.block_id is None else FrameType.BLOCK_DATA
        ticks = self.firmware.ready_ticks(data.first_sample)
        header = self.firmware.header(kind, first_sample=data.first_sample, ticks=ticks)
        if kind is FrameType.BLOCK_DATA and Fault.BLOCK_LOSS in self._faults:
            self._block_frames += 1
            if self._block_frames % LOST_BLOCK_FRAME == 0:
                return
        self._queue(header, encode_samples(data))

    def _queue(self, header: Header, payload: bytes) -> None:
        if Fault.BOARD_SILENCE in self._faults:
            return
        frame = encode_frame(header, payload)
        if Fault.BOARD_GARBAGE in self._faults:
            frame = self._rng.bytes(len(frame))
        self.port.queue(frame)
