"""Triggered blocks: put together by sample index, asked for again where samples are missing.

What stays missing stays missing: a block is handed on with its longest unbroken run of samples,
never with a hole filled in.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.board.records import BlockInfo, Samples

__all__ = ["BlockAssembler", "BlockCollector", "CapturedBlock", "Resend"]

MOST_STRETCHES = 8  # asked for at a time: more a board's queue need not take


@dataclass(frozen=True, slots=True, kw_only=True)
class CapturedBlock:
    """A block as it came.

    `counts` (n, n_channels) begins at sample `first_sample`; `missing` is how many of the block's
    samples it lacks.
    """

    info: BlockInfo
    first_sample: int
    counts: npt.NDArray[np.int32]
    missing: int
    last_data_s: float  # host clock when its last data came
    announced_s: float  # host clock when BLOCK_READY came


@dataclass(frozen=True, slots=True, kw_only=True)
class Resend:
    """Samples of a block to ask for again; a count of 0 asks for BLOCK_READY alone."""

    block_id: int
    first: int
    count: int


class BlockAssembler:
    """One block in the making."""

    def __init__(self, info: BlockInfo, n_channels: int, now_s: float) -> None:
        self.info = info
        self.announced_s = now_s
        self.last_data_s = now_s
        self.rounds = 0
        self._asked_to = 0  # offset up to which this round has asked
        self._counts = np.zeros((info.length, n_channels), dtype=np.int32)
        self._present = np.zeros(info.length, dtype=np.bool_)
        self._n_present = 0

    @property
    def complete(self) -> bool:
        """Whether every sample is there."""
        return self._n_present == self.info.length

    def add(self, samples: Samples, now_s: float) -> bool:
        """Put samples where they belong; False, and nothing taken, if they are not the block's."""
        start = samples.first_sample - self.info.first_sample
        end = start + samples.counts.shape[0]
        if start < 0 or end > self.info.length or samples.counts.shape[1] != self._counts.shape[1]:
            return False
        self._counts[start:end] = samples.counts
        self._present[start:end] = True
        self._n_present = int(np.count_nonzero(self._present))
        self.last_data_s = now_s
        return True

    def missing(self) -> tuple[tuple[int, int], ...]:
        """Return (first offset, count) of every stretch that is missing, in order."""
        return _runs(~self._present)

    def ask_again(self, most: int, now_s: float) -> tuple[tuple[int, int], ...]:
        """Return the next missing stretches of a round, at most `most`.

        A round asks for every missing stretch once, and counts when it has.
        """
        left = tuple(run for run in self.missing() if run[0] >= self._asked_to)
        asked = left[:most]
        if len(left) > most:
            first, count = asked[-1]
            self._asked_to = first + count
        else:
            self._asked_to = 0
            self.rounds += 1
        if asked:
            self.last_data_s = now_s
        return asked

    def captured(self) -> CapturedBlock:
        """Return the block, whole or as its longest unbroken run."""
        runs = _runs(self._present)
        first, count = max(runs, key=lambda run: run[1], default=(0, 0))
        return CapturedBlock(
            info=self.info,
            first_sample=self.info.first_sample + first,
            counts=frozen_array(self._counts[first : first + count], np.int32),
            missing=self.info.length - count,
            last_data_s=self.last_data_s,
            announced_s=self.announced_s,
        )


class BlockCollector:
    """All blocks in the making, within a bounded memory.

    Parameters
    ----------
    n_channels
        Channels of every block.
    resend_after_s
        Silence in lab seconds after which missing samples are asked for, and the time in which
        at most `MOST_STRETCHES` are.
    max_rounds
        Times each of them is asked for before the block is handed on as it is.
    max_blocks
        Blocks put together at a time; the board holds the others.
    """

    def __init__(
        self,
        n_channels: int,
        *,
        block_length: int,
        resend_after_s: float,
        max_rounds: int = 4,
        max_blocks: int = 4,
    ) -> None:
        self._n_channels = n_channels
        self._block_length = block_length
        self._resend_after_s = resend_after_s
        self._max_rounds = max_rounds
        self._max_blocks = max_blocks
        self._open: dict[int, BlockAssembler] = {}
        self._done: deque[int] = deque(maxlen=1024)
        self._asking_since_s = -math.inf
        self._may_ask = 0  # stretches, until `resend_after_s` has passed since then
        self.foreign_frames = 0

    def __len__(self) -> int:
        return len(self._open)

    def announce(self, info: BlockInfo, now_s: float) -> bool:
        """Take a BLOCK_READY in; False if it is known, done, too many, or not what was set up."""
        if info.block_id in self._open or info.block_id in self._done:
            return False
        if len(self._open) >= self._max_blocks or info.length != self._block_length:
            return False
        self._open[info.block_id] = BlockAssembler(info, self._n_channels, now_s)
        return True

    def knows(self, block_id: int) -> bool:
        """Whether the block is being put together or has been."""
        return block_id in self._open or block_id in self._done

    def add(self, samples: Samples, now_s: float) -> None:
        """Take BLOCK_DATA in; data of a block that is not open is counted and left."""
        block = self._open.get(samples.block_id or 0)
        if block is None or not block.add(samples, now_s):
            self.foreign_frames += 1

    def take(self, now_s: float) -> CapturedBlock | None:
        """Return the oldest block if it is complete, or as it is once asking has not helped."""
        if not self._open:
            return None
        block_id = min(self._open)
        block = self._open[block_id]
        waited = now_s - block.last_data_s > self._resend_after_s
        if not block.complete and not (waited and block.rounds >= self._max_rounds):
            return None
        del self._open[block_id]
        self._done.append(block_id)
        return block.captured()

    def overdue(self, now_s: float) -> tuple[Resend, ...]:
        """Return what to ask for again, the oldest block first."""
        if now_s - self._asking_since_s > self._resend_after_s:
            self._asking_since_s, self._may_ask = now_s, MOST_STRETCHES
        wanted: list[Resend] = []
        for block_id, block in sorted(self._open.items()):
            if self._may_ask == 0:
                break
            silent = now_s - block.last_data_s > self._resend_after_s
            if block.complete or not silent or block.rounds >= self._max_rounds:
                continue
            asked = block.ask_again(self._may_ask, now_s)
            self._may_ask -= len(asked)
            wanted += [Resend(block_id=block_id, first=f, count=n) for f, n in asked]
        return tuple(wanted)


def _runs(flags: npt.NDArray[np.bool_]) -> tuple[tuple[int, int], ...]:
    """Return (start, length) of every run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return tuple(
        (int(start), int(end - start)) for start, end in zip(edges[::2], edges[1::2], strict=True)
    )
