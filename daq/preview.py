"""The free-running stream: watched for gaps, and drawn as an envelope for the screen.

Nothing that is judged or kept comes from it, so its counts are unpacked only for the envelope,
many frames at a time.
"""

from __future__ import annotations

import numpy as np

from armodal.daq.events import Preview
from armodal.protocols.board.layout import layout_of
from armodal.protocols.board.messages import STREAM_HEAD_SIZE
from armodal.protocols.board.records import Frame, StreamHead
from armodal.protocols.board.samples import BYTES_PER_COUNT, unpack_counts

__all__ = ["PREVIEW_EVERY_WALL_S", "StreamWatch"]

PREVIEW_EVERY_WALL_S = 0.08  # with a turn's delay still more than ten a second
BINS = 64
MOST_BYTES = 2**20
_HEAD = layout_of(StreamHead).form


class StreamWatch:
    """Follow the preview stream of a board, from the first sample after START.

    Attributes
    ----------
    samples : int
        Samples received.
    missing : int
        Samples that never came, by the sample index.
    malformed : int
        Frames whose payload is not what their head says.
    last_gap : int or None
        Index of the first sample of the last gap.
    """

    def __init__(self, n_channels: int) -> None:
        self._n_channels = n_channels
        self._expected = 0
        self._parts: list[bytes] = []
        self._first_sample = 0
        self._n_samples = 0
        self.samples = 0
        self.missing = 0
        self.malformed = 0
        self.last_gap: int | None = None

    def add(self, frame: Frame) -> None:
        """Take a STREAM frame in."""
        payload = frame.payload
        if len(payload) < STREAM_HEAD_SIZE:
            self.malformed += 1
            return
        n_samples, n_channels, size = _HEAD.unpack_from(payload)
        n_bytes = n_samples * n_channels * BYTES_PER_COUNT
        if (
            n_channels != self._n_channels
            or size != BYTES_PER_COUNT
            or n_samples == 0
            or len(payload) != STREAM_HEAD_SIZE + n_bytes
        ):
            self.malformed += 1
            return
        first = frame.header.first_sample
        if first > self._expected:
            self.missing += first - self._expected
            self.last_gap = self._expected
        self._expected = first + n_samples
        self.samples += n_samples
        if not self._parts:
            self._first_sample = first
        if (self._n_samples + n_samples) * self._n_channels * BYTES_PER_COUNT <= MOST_BYTES:
            self._parts.append(payload[STREAM_HEAD_SIZE:])
            self._n_samples += n_samples

    @property
    def expected(self) -> int:
        """Index of the sample that comes next."""
        return self._expected

    def preview(self) -> Preview | None:
        """Return the envelope of what has come since the last one, or None of nothing."""
        if not self._parts:
            return None
        counts = unpack_counts(b"".join(self._parts), self._n_channels)
        starts = np.unique(np.linspace(0, len(counts), BINS, endpoint=False).astype(np.intp))
        envelope = Preview(
            first_sample=self._first_sample,
            n_samples=len(counts),
            lowest=np.minimum.reduceat(counts, starts, axis=0),
            highest=np.maximum.reduceat(counts, starts, axis=0),
        )
        self._parts.clear()
        self._n_samples = 0
        return envelope
