"""Blocks that the board has sent, each beside the preview it was cut out of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.daq.check.board_bench import BoardBench
from armodal.daq.check.probe import BoardProbe, BoardStepError
from armodal.daq.check.raw_frame import RawFrame
from armodal.daq.check.stream import Stream, record, stream_of
from armodal.protocols.board.messages import (
    decode_payload,
    decode_samples,
    encode_payload,
)
from armodal.protocols.board.records import (
    BlockInfo,
    Configuration,
    FrameType,
    Release,
    Slope,
)

__all__ = ["Capture", "Level", "SentBlock", "blocks_of", "capture", "noise_level"]

NOISE_S = 0.3
FEWEST_NOISE_SAMPLES = 256
QUIETEST_COUNTS = 1.0  # standard deviation below which a level cannot be set within the noise
BLOCK_LENGTH = 200
PRETRIGGER = 77
BLOCKS = 4
CAPTURE_TIMEOUT_S = 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """A trigger channel and a level one standard deviation above its mean, in counts."""

    channel: int
    mean_counts: float
    std_counts: float

    @property
    def level(self) -> int:
        """Trigger level, counts."""
        return round(self.mean_counts + self.std_counts)


@dataclass(frozen=True, slots=True, kw_only=True)
class SentBlock:
    """A block by its BLOCK_READY, with the data that came between it and the next one.

    `pieces` are the payloads of its BLOCK_DATA frames with the offset each names, as they came.
    """

    info: BlockInfo
    pieces: tuple[tuple[int, npt.NDArray[np.int32]], ...]

    @property
    def samples(self) -> int:
        """Samples that came."""
        return sum(len(counts) for _, counts in self.pieces)

    @property
    def in_order(self) -> bool:
        """Whether the pieces follow each other without hole or overlap."""
        ends = [offset + len(counts) for offset, counts in self.pieces]
        return all(offset == end for (offset, _), end in zip(self.pieces[1:], ends, strict=False))

    @property
    def counts(self) -> npt.NDArray[np.int32]:
        """All pieces one after another, (n, n_channels)."""
        return np.concatenate([counts for _, counts in self.pieces])


@dataclass(frozen=True, slots=True, kw_only=True)
class Capture:
    """A run with the trigger within the noise."""

    configuration: Configuration
    column: int  # of the trigger channel among those sent
    stream: Stream
    blocks: tuple[SentBlock, ...]


def noise_level(bench: BoardBench) -> Level | None:
    """Return a level within the noise of the noisiest channel; None if all are too quiet."""
    rate_hz = bench.rate_hz
    lab_s = max(NOISE_S, FEWEST_NOISE_SAMPLES / float(rate_hz))
    stream = record(bench.probe, bench.configuration(rate_hz), lab_s).stream
    counts = stream.counts[stream.present].astype(np.float64)
    if len(counts) < 2:
        raise BoardStepError("no preview came to find the noise by")
    stds = counts.std(axis=0)
    channel = int(stds.argmax())
    if stds[channel] < QUIETEST_COUNTS:
        return None
    return Level(
        channel=channel,
        mean_counts=float(counts[:, channel].mean()),
        std_counts=float(stds[channel]),
    )


def blocks_of(frames: list[RawFrame]) -> list[SentBlock]:
    """Return what was sent of blocks, one entry for each BLOCK_READY, in order."""
    found: list[tuple[BlockInfo, list[tuple[int, npt.NDArray[np.int32]]]]] = []
    for raw in frames:
        if raw.type == FrameType.BLOCK_READY:
            found.append((decode_payload(BlockInfo, raw.payload), []))
        elif raw.type == FrameType.BLOCK_DATA:
            samples = decode_samples(raw.frame())
            for info, pieces in reversed(found):
                if info.block_id == samples.block_id:
                    pieces.append((samples.first_sample - info.first_sample, samples.counts))
                    break
            else:
                raise BoardStepError(
                    f"BLOCK_DATA of block {samples.block_id} without a BLOCK_READY before it"
                )
    return [SentBlock(info=info, pieces=tuple(pieces)) for info, pieces in found]


def whole_blocks(probe: BoardProbe) -> int:
    """Return how many blocks have come with as many samples as they announce."""
    return sum(block.samples >= block.info.length for block in blocks_of(probe.frames))


def capture(bench: BoardBench, level: Level, slope: Slope) -> Capture:
    """Let the noise trigger a few blocks, releasing each once it is here.

    Raises
    ------
    BoardStepError
        If they do not come.
    """
    configuration = bench.configuration(
        bench.rate_hz,
        trigger_channel=level.channel,
        trigger_level_counts=level.level,
        slope=slope,
        pretrigger=PRETRIGGER,
        block_length=BLOCK_LENGTH,
    )
    probe = bench.probe
    probe.begin(configuration)
    released: set[int] = set()

    def enough() -> bool:
        return len({b.info.block_id for b in blocks_of(probe.frames)}) > BLOCKS

    wall_s = max(1.0, bench.clock.wall_s(CAPTURE_TIMEOUT_S))
    until_s = bench.clock.now_s() + wall_s / bench.clock.wall_s(1.0)
    while len(released) < BLOCKS and bench.clock.now_s() < until_s:
        probe.collect(0.1, enough)
        for block in blocks_of(probe.frames):
            if block.samples >= block.info.length and block.info.block_id not in released:
                probe.want_ok(
                    FrameType.RELEASE, encode_payload(Release(block_id=block.info.block_id))
                )
                released.add(block.info.block_id)
    probe.end()
    blocks = [b for b in blocks_of(probe.frames) if b.info.block_id in released]
    if not blocks:
        raise BoardStepError(
            f"no block came in {CAPTURE_TIMEOUT_S:g} s with the level at {level.level} counts, "
            f"one standard deviation above the mean of channel {level.channel}"
        )
    return Capture(
        configuration=configuration,
        column=level.channel,
        stream=stream_of(probe.frames, configuration.channel_mask.bit_count()),
        blocks=tuple(blocks),
    )
