"""A run of the board as it came: frames, round trips, and the samples laid out by their index."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.daq.check.probe import BoardProbe
from armodal.daq.check.raw_frame import RawFrame
from armodal.daq.clock_fit import RoundTrip
from armodal.protocols.arrays import frozen_array
from armodal.protocols.board.messages import decode_samples
from armodal.protocols.board.records import BoardStatus, Configuration, FrameType
from armodal.protocols.errors import FrameError

__all__ = ["Recording", "Stream", "record", "stream_of"]

STATUS_INTERVALS = 60
SHORTEST_INTERVAL_WALL_S = 0.005
LONGEST_INTERVAL_S = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """Samples by index; where `present` is false the counts are 0 and mean nothing."""

    counts: npt.NDArray[np.int32]  # (n, n_channels)
    present: npt.NDArray[np.bool_]  # (n,)
    first: npt.NDArray[np.int64]  # (n_frames,) index of the first sample, as they came
    lengths: npt.NDArray[np.int64]  # (n_frames,)
    ticks: npt.NDArray[np.uint64]  # (n_frames,)

    @property
    def unbroken(self) -> int:
        """Samples from the first one on without a hole."""
        return int(len(self.present) if self.present.all() else np.argmin(self.present))


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """A run with the preview on."""

    configuration: Configuration
    frames: tuple[RawFrame, ...]
    faults: tuple[str, ...]
    statuses: tuple[tuple[BoardStatus, RoundTrip], ...]
    stream: Stream


def stream_of(frames: list[RawFrame] | tuple[RawFrame, ...], n_channels: int) -> Stream:
    """Lay out the samples of the STREAM frames among `frames`.

    Raises
    ------
    FrameError
        If a frame's payload is malformed, or carries another number of channels.
    """
    parts = [
        (frame, decode_samples(frame.frame()).counts)
        for frame in frames
        if frame.type == FrameType.STREAM
    ]
    if any(counts.shape[1] != n_channels for _, counts in parts):
        raise FrameError(f"a STREAM frame does not carry the {n_channels} channels configured")
    # An index from a broken board must not take all memory.
    most = 2 * sum(len(counts) for _, counts in parts) + 1_000_000
    parts = [(frame, counts) for frame, counts in parts if frame.first_sample < most]
    n = max((frame.first_sample + len(counts) for frame, counts in parts), default=0)
    counts_all = np.zeros((n, n_channels), dtype=np.int32)
    present = np.zeros(n, dtype=np.bool_)
    for frame, counts in parts:
        end = frame.first_sample + len(counts)
        counts_all[frame.first_sample : end] = counts
        present[frame.first_sample : end] = True
    return Stream(
        counts=frozen_array(counts_all, np.int32),
        present=frozen_array(present, np.bool_),
        first=frozen_array([frame.first_sample for frame, _ in parts], np.int64),
        lengths=frozen_array([len(counts) for _, counts in parts], np.int64),
        ticks=frozen_array([frame.ticks for frame, _ in parts], np.uint64),
    )


def record(
    probe: BoardProbe,
    configuration: Configuration,
    lab_s: float,
    *,
    most_s: float = 0.0,
    enough: Callable[[Sequence[RoundTrip]], bool] = bool,
) -> Recording:
    """Run the board for `lab_s` lab seconds, asking STATUS all along.

    After that it runs on until the round trips are `enough`, or `most_s` have passed.
    """
    shortest_s = SHORTEST_INTERVAL_WALL_S / probe.clock.wall_s(1.0)
    pause_s = min(max(lab_s / STATUS_INTERVALS, shortest_s), LONGEST_INTERVAL_S)
    probe.begin(configuration)
    begin_s = probe.clock.now_s()
    statuses = [probe.status_trip()]
    while (passed_s := probe.clock.now_s() - begin_s) < lab_s or (
        passed_s < most_s and not enough([trip for _, trip in statuses])
    ):
        probe.collect(pause_s)
        statuses.append(probe.status_trip())
    frames, faults = tuple(probe.frames), tuple(probe.faults)
    probe.end()
    return Recording(
        configuration=configuration,
        frames=frames,
        faults=faults,
        statuses=tuple(statuses),
        stream=stream_of(frames, configuration.channel_mask.bit_count()),
    )
