"""Trigger and block capture as the board does it, `docs/board-protocol.md`, section 8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from protocols.board.records import Configuration, Slope

__all__ = ["Block", "BlockCapture"]

Counts = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Samples around a trigger."""

    first_sample: int
    trigger_sample: int
    counts: Counts  # (length, n_channels)


class BlockCapture:
    """Look for triggers in consecutive samples and cut blocks out of them.

    Parameters
    ----------
    configuration
        Trigger, pre-trigger and length, already accepted.
    n_channels
        Channels of the samples that come.
    trigger_column
        Column of the trigger channel among them.

    Attributes
    ----------
    next_sample : int
        Index of the next sample.
    missed : int
        Triggers without a free buffer, and blocks given up because samples were lost.
    """

    def __init__(
        self, configuration: Configuration, *, n_channels: int, trigger_column: int
    ) -> None:
        self._before = configuration.pretrigger
        self._length = configuration.block_length
        self._level = configuration.trigger_level_counts
        self._sign = 1 if configuration.slope is Slope.RISING else -1
        self._column = trigger_column
        self._tail: Counts = np.empty((0, n_channels), dtype=np.int32)
        self._kept = max(self._before, 1)
        self._armed_from = self._before  # no trigger before this sample
        self._open: Counts | None = None
        self._open_trigger = 0
        self._filled = 0
        self.next_sample = 0
        self.missed = 0

    def feed(self, counts: Counts, free_buffers: int) -> list[Block]:
        """Take consecutive samples (n, n_channels); return the blocks they completed.

        A block being filled takes one of the `free_buffers`.
        """
        first = self.next_sample
        window = np.concatenate((self._tail, counts))
        offset = len(self._tail)
        crossings = self._crossings(window[:, self._column]) - offset
        complete: list[Block] = []
        position = 0
        while position < len(counts):
            if self._open is not None:
                position += self._fill(self._open, counts[position:])
                if self._filled == self._length:
                    complete.append(self._close())
                continue
            position = max(position, self._armed_from - first)
            later = crossings[crossings >= position]
            if not len(later):
                break
            trigger = int(later[0])
            begin = offset + trigger - self._before
            if free_buffers - len(complete) < 1:
                self.missed += 1
                position = trigger - self._before + self._length
                self._armed_from = max(self._armed_from, first + position)
                continue
            self._open = np.empty((self._length, counts.shape[1]), dtype=np.int32)
            self._open_trigger = first + trigger
            self._filled = 0
            position = trigger - self._before + self._fill(self._open, window[begin:])
            if self._filled == self._length:
                complete.append(self._close())
        self.next_sample = first + len(counts)
        self._tail = window[max(0, len(window) - self._kept) :].copy()
        return complete

    def lose(self, count: int) -> None:
        """Samples were lost: the index jumps, and a block never has a hole."""
        self.missed += self._open is not None
        self._open = None
        self.next_sample += count
        self._tail = self._tail[:0]
        self._armed_from = self.next_sample + self._before

    def _crossings(self, values: Counts) -> npt.NDArray[np.intp]:
        """Indices of samples at which the level is crossed in the wanted direction."""
        signed, level = self._sign * values, self._sign * self._level
        return np.flatnonzero((signed[:-1] < level) & (signed[1:] >= level)) + 1

    def _fill(self, block: Counts, samples: Counts) -> int:
        taken = min(self._length - self._filled, len(samples))
        block[self._filled : self._filled + taken] = samples[:taken]
        self._filled += taken
        return taken

    def _close(self) -> Block:
        counts, self._open = self._open, None
        if counts is None:
            raise RuntimeError("no block is open")
        counts.setflags(write=False)
        return Block(
            first_sample=self._open_trigger - self._before,
            trigger_sample=self._open_trigger,
            counts=counts,
        )
