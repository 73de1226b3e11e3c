"""What faults do to the board's frames on the line, and to its channels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.faults import Fault, FaultSet
from armodal.hil_sim.front_end import FULL_SCALE_COUNTS
from armodal.hil_sim.streams import Streams
from armodal.protocols.board.codec import decode_frame
from armodal.protocols.board.records import FrameType

__all__ = ["ChannelFaults", "LinkFaults"]

HIT_SHARE = 0.3  # of the frames, while a fault of the line lasts
LOST_BLOCK_FRAME = 7
SATURATION = 64  # amplification of a channel that clips


class LinkFaults:
    """The line from the board: frames in, bytes out.

    Parameters
    ----------
    faults
        What goes wrong at present.
    streams
        By fault: draw the frames and bits that it hits.
    """

    def __init__(self, faults: FaultSet, streams: Streams) -> None:
        self._faults = faults
        self._rng = {fault: streams(fault) for fault in Fault}
        self._late = b""
        self._block_frames = 0

    def carry(self, frame: bytes) -> bytes:
        """Return what comes out for a frame with its delimiters; perhaps nothing."""
        faults = self._faults
        if Fault.BOARD_SILENCE in faults or self._is_seventh_block(frame):
            return b""
        if Fault.BOARD_GARBAGE in faults:
            return self._rng[Fault.BOARD_GARBAGE].bytes(len(frame))
        late, self._late = self._late, b""
        if self._hits(Fault.FRAME_REORDER) and not late:
            self._late = frame
            return b""
        if self._hits(Fault.FRAME_DROP):
            return late
        if self._hits(Fault.FRAME_DUPLICATE):
            frame += frame
        if self._hits(Fault.BIT_FLIP):
            frame = self._flipped(frame)
        if self._hits(Fault.FRAME_TRUNCATE):
            frame = frame[: int(self._rng[Fault.FRAME_TRUNCATE].integers(1, len(frame)))]
        return frame + late

    def _hits(self, fault: Fault) -> bool:
        return fault in self._faults and bool(self._rng[fault].random() < HIT_SHARE)

    def _flipped(self, frame: bytes) -> bytes:
        flipped, rng = bytearray(frame), self._rng[Fault.BIT_FLIP]
        flipped[rng.integers(len(frame))] ^= 1 << int(rng.integers(8))
        return bytes(flipped)

    def _is_seventh_block(self, frame: bytes) -> bool:
        if Fault.BLOCK_LOSS not in self._faults:
            return False
        if decode_frame(frame[1:-1]).header.type is not FrameType.BLOCK_DATA:
            return False
        self._block_frames += 1
        return self._block_frames % LOST_BLOCK_FRAME == 0


class ChannelFaults:
    """Channels that do not measure; which one is drawn when the fault begins."""

    def __init__(self, faults: FaultSet, streams: Streams) -> None:
        self._faults = faults
        self._rng = {fault: streams(fault) for fault in Fault}
        self._channels: dict[Fault, int] = {}
        self._held = 0

    def spoil(self, counts: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """Return counts (n, n_channels) as the converter gives them."""
        for fault in (Fault.CHANNEL_STUCK, Fault.CHANNEL_CLIPPED, Fault.CHANNEL_GARBAGE):
            if fault not in self._faults:
                self._channels.pop(fault, None)
                continue
            if len(counts) == 0:
                continue
            counts = counts.copy()
            if fault not in self._channels:
                self._channels[fault] = int(self._rng[fault].integers(counts.shape[1]))
                self._held = int(counts[0, self._channels[fault]])
            counts[:, self._channels[fault]] = self._spoilt(fault, counts[:, self._channels[fault]])
        return counts

    def _spoilt(self, fault: Fault, column: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
        low, high = -FULL_SCALE_COUNTS - 1, FULL_SCALE_COUNTS
        if fault is Fault.CHANNEL_STUCK:
            return np.full(len(column), self._held)
        if fault is Fault.CHANNEL_CLIPPED:
            return np.clip(SATURATION * column.astype(np.int64), low, high)
        return self._rng[fault].integers(low, high + 1, len(column))
