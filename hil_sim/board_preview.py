"""The board's free-running preview: samples in frames, dropped where the link is busy."""

from __future__ import annotations

from collections import deque
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from protocols.board.limits import samples_per_frame
from protocols.board.records import Samples

__all__ = ["BoardPreview"]

QUEUE = 32  # frames
DELAY_S = 0.02  # a frame is not held back longer, `docs/board-protocol.md`, section 9

Counts = npt.NDArray[np.int32]


class BoardPreview:
    """Frames of the preview that wait for room on the link.

    Attributes
    ----------
    dropped : int
        Samples that found no room in the queue.
    """

    def __init__(self, *, rate_hz: Fraction, n_channels: int) -> None:
        self._full = samples_per_frame(n_channels)
        self._wanted = min(self._full, max(1, int(DELAY_S * rate_hz)))
        self._gathered: list[Counts] = []
        self._first = 0
        self._n = 0
        self._frames: deque[Samples] = deque()
        self.dropped = 0

    def __len__(self) -> int:
        return len(self._frames)

    def add(self, first_sample: int, counts: Counts) -> None:
        """Take consecutive samples (n, n_channels)."""
        if not self._n:
            self._first = first_sample
        self._gathered.append(counts)
        self._n += len(counts)
        if self._n >= self._wanted:
            self.end_frame()

    def end_frame(self) -> None:
        """Send what was gathered, though it may not fill a frame."""
        if not self._n:
            return
        joined = np.concatenate(self._gathered)
        self._gathered, self._n = [], 0
        for begin in range(0, len(joined), self._full):
            counts = joined[begin : begin + self._full]
            if len(self._frames) < QUEUE:
                self._frames.append(Samples(first_sample=self._first + begin, counts=counts))
            else:
                self.dropped += len(counts)

    def next_frame(self) -> Samples | None:
        """Return the oldest waiting frame, if any."""
        return self._frames.popleft() if self._frames else None
