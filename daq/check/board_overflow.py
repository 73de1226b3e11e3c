"""Steps: blocks are not released, or nobody reads; the board owns up to every loss."""

from __future__ import annotations

import itertools

import numpy as np

from armodal.daq.check.board_bench import BoardBench
from armodal.daq.check.board_blocks import TOO_QUIET, released_all
from armodal.daq.check.captured import PRETRIGGER, Level, blocks_of, noise_level
from armodal.daq.check.raw_frame import RawFrame
from armodal.daq.check.stream import Stream, stream_of
from armodal.daq.check.trigger_truth import expected_blocks
from armodal.daq.check.verdict import Finding, failed, passed, unchecked
from armodal.protocols.board.limits import refusal
from armodal.protocols.board.records import BoardStatus, Configuration, FrameType, Overflow
from armodal.protocols.board.samples import BYTES_PER_COUNT
from armodal.protocols.board.sequence import sequence_gap

__all__ = ["check_block_overflow", "check_stream_overflow"]

BUFFERS = 3
MISSES = 2  # triggers without a buffer that are waited for
LONGEST_FILL_S = 120.0
STALLS_S = (0.25, 1.0, 4.0)
SHORTEST_STALL_WALL_S = 0.05
CATCH_UP_S = 10.0
CATCH_UP_WALL_S = 1.0


def check_block_overflow(bench: BoardBench) -> Finding:
    """Step `block-overflow`: release nothing until triggers are missed, and count with it."""
    level = noise_level(bench)
    if level is None:
        return unchecked(TOO_QUIET)
    configuration = _filling(bench, level)
    if configuration is None:
        return unchecked("no block that fills a third of the buffer is within the link's limits")
    length, rate_hz = configuration.block_length, float(configuration.rate_hz)
    n_channels = configuration.channel_mask.bit_count()
    buffers = bench.dictionary.block_capacity // (BYTES_PER_COUNT * n_channels * length)
    fill_s = (buffers + MISSES + 1) * length / rate_hz
    if fill_s > LONGEST_FILL_S:
        return unchecked(f"the buffer takes {fill_s:.0f} s to fill; name a higher --rate")
    probe = bench.probe
    probe.begin(configuration)
    limit_s = bench.clock.now_s() + 2.0 * fill_s + 1.0 / bench.clock.wall_s(1.0)
    statuses = [(probe.status(), _last_reply(probe.frames))]
    while statuses[-1][0].triggers_missed < MISSES and bench.clock.now_s() < limit_s:
        probe.collect(0.25 * length / rate_hz)
        statuses.append((probe.status(), _last_reply(probe.frames)))
        owing = statuses[-1][0].next_sample > 1.5 * (buffers + MISSES + 1) * length
        if owing:
            break
    probe.end()
    final = probe.status()
    statuses.append((final, _last_reply(probe.frames)))
    probe.settle()
    blocks = blocks_of(probe.frames)
    problems = _flag_problems(statuses)
    if len(blocks) != buffers or final.buffered_blocks != buffers:
        problems.append(
            f"the buffer holds {buffers} blocks of {length} samples; {len(blocks)} were sent, "
            f"STATUS says {final.buffered_blocks}"
        )
    if blocks and final.oldest_block != blocks[0].info.block_id:
        problems.append(f"oldest block {blocks[0].info.block_id}, STATUS says {final.oldest_block}")
    stream = stream_of(probe.frames, n_channels)
    low, high = _missed_bounds(configuration, level, stream, final, buffers)
    if not low <= final.triggers_missed <= high:
        wanted = str(low) if low == high else f"{low} to {high}"
        problems.append(
            f"{wanted} triggers found no buffer up to sample {final.next_sample}, STATUS says "
            f"{final.triggers_missed}"
        )
    released_all(bench, [block.info.block_id for block in blocks])
    if bench.probe.status().buffered_blocks:
        problems.append("blocks are held after all were released")
    if problems:
        return failed(problems)
    return passed(
        f"{buffers} blocks held, {final.triggers_missed} triggers missed, counted and flagged"
    )


def _filling(bench: BoardBench, level: Level) -> Configuration | None:
    """Return a configuration of which the buffer holds three blocks, or more where it must."""
    n_channels = len(bench.dictionary.channels)
    length = bench.dictionary.block_capacity // (BYTES_PER_COUNT * n_channels * BUFFERS)
    while length > 0:
        configuration = bench.configuration(
            bench.rate_hz,
            trigger_channel=level.channel,
            trigger_level_counts=level.level,
            pretrigger=min(PRETRIGGER, length - 1),
            block_length=length,
        )
        if refusal(configuration, bench.dictionary) is None:
            return configuration
        length //= 2
    return None


def _last_reply(frames: list[RawFrame]) -> RawFrame:
    return next(f for f in reversed(frames) if f.type == FrameType.STATUS_REPLY)


def _flag_problems(statuses: list[tuple[BoardStatus, RawFrame]]) -> list[str]:
    for status, reply in statuses:
        flagged = bool(reply.overflow & Overflow.BLOCK)
        if flagged != bool(status.triggers_missed):
            return [
                (
                    f"with {status.triggers_missed} triggers missed by STATUS, the flag BLOCK is "
                    f"{'set' if flagged else 'not set'}"
                )
            ]
    return []


def _missed_bounds(
    configuration: Configuration, level: Level, stream: Stream, final: BoardStatus, buffers: int
) -> tuple[int, int]:
    """How many triggers must have been missed, given what is known of the samples."""
    length = configuration.block_length
    known = stream.unbroken
    expected = expected_blocks(
        stream.counts[:known, level.channel],
        level=configuration.trigger_level_counts,
        slope=configuration.slope,
        pretrigger=configuration.pretrigger,
        length=length,
        buffers=buffers,
    )
    # Each miss takes a block's length; where the preview ends early, that many more fit at most.
    unknown = max(0, final.next_sample - known)
    return len(expected.missed), len(expected.missed) + (-(-unknown // length) if unknown else 0)


def check_stream_overflow(bench: BoardBench) -> Finding:
    """Step `stream-overflow`: do not read for a while; every sample missing is owned up to."""
    configuration = bench.configuration(bench.rate_hz)
    for stall_s in STALLS_S:
        probe = bench.probe
        probe.begin(configuration)
        probe.collect(0.1)
        bench.clock.sleep(max(stall_s, SHORTEST_STALL_WALL_S / bench.clock.wall_s(1.0)))
        caught_up = _catch_up(bench)
        status = probe.status()
        frames = list(probe.frames)
        probe.end()
        found = _stall_finding(configuration, frames, status, stall_s, caught_up=caught_up)
        if found is not None:
            return found
    return unchecked(
        f"the line took everything while nobody read for {STALLS_S[-1]:g} s: its buffers hold more"
    )


def _catch_up(bench: BoardBench) -> bool:
    """Read until the preview has come to where the board was, with nothing dropped since."""
    probe = bench.probe
    wait_s = max(CATCH_UP_S, CATCH_UP_WALL_S / bench.clock.wall_s(1.0))
    until_s = bench.clock.now_s() + wait_s
    while bench.clock.now_s() < until_s:
        before = probe.status()

        def there(sample: int = before.next_sample) -> bool:
            return any(
                f.type == FrameType.STREAM and f.first_sample >= sample for f in probe.frames[-256:]
            )

        probe.collect(until_s - bench.clock.now_s(), there)
        if probe.status().stream_samples_dropped == before.stream_samples_dropped and there():
            return True
    return False


def _stall_finding(
    configuration: Configuration,
    frames: list[RawFrame],
    status: BoardStatus,
    stall_s: float,
    *,
    caught_up: bool,
) -> Finding | None:
    """Return what a stall has shown; None if nothing was lost in it."""
    stream = stream_of(frames, configuration.channel_mask.bit_count())
    missing = int(np.count_nonzero(~stream.present))
    dropped = status.stream_samples_dropped
    if missing == 0 and dropped == 0:
        return None
    if not caught_up:
        return failed(f"the preview had not caught up {CATCH_UP_S:g} s after a stall")
    gaps = [
        sequence_gap((a.sequence + 1) & 0xFFFFFFFF, b.sequence)
        for a, b in itertools.pairwise(frames)
    ]
    if any(gap > 0 for gap in gaps):
        return unchecked(
            f"the link lost {sum(g for g in gaps if g > 0)} frames while nobody read: it has no "
            "flow control, so the board's own drops cannot be told apart"
        )
    problems = []
    if missing != dropped:
        problems.append(
            f"after {stall_s:g} s without reading {missing} samples are missing, STATUS owns up "
            f"to {dropped}"
        )
    streams = [f for f in frames if f.type == FrameType.STREAM]
    hole = int(np.argmin(stream.present))
    silent = [f for f in streams if f.first_sample > hole and not f.overflow & Overflow.STREAM]
    if missing and silent:
        problems.append(
            f"the flag STREAM is not set in {len(silent)} frames behind the hole at sample {hole}"
        )
    if problems:
        return failed(problems)
    return passed(f"{missing} samples dropped in {stall_s:g} s, all counted and flagged")
