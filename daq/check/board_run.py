"""Steps: a long run brings every sample once, in whole frames, at the rate and time stated."""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np

from armodal.daq.check.board_bench import BoardBench
from armodal.daq.check.stream import Recording
from armodal.daq.check.tick_rate import TickRate, tick_rate
from armodal.daq.check.verdict import Finding, failed, passed, unchecked
from armodal.protocols.board.codec import PROTOCOL_VERSION
from armodal.protocols.board.messages import decode_samples
from armodal.protocols.board.records import FrameType, Overflow
from armodal.protocols.board.sequence import sequence_gap
from armodal.protocols.errors import FrameError

__all__ = ["check_clock", "check_framing", "check_rate", "check_samples"]

CRYSTAL_PPM = 200.0  # an ordinary crystal keeps 100 ppm with all tolerances; twice is a fault
LATCH_S = 10e-6  # ticks of a data frame are within this of the truth, section 3
# What the host may hold back between a sample and its being seen in STATUS, lab and wall seconds.
STATUS_LAG_S = 0.1
STATUS_LAG_WALL_S = 0.05


def check_framing(bench: BoardBench) -> Finding:
    """Step `framing`: CRC, type, session, hash and sequence of every frame of the run."""
    recording = bench.recording()
    problems = []
    if recording.faults:
        most = Counter(fault.split(" is ")[0] for fault in recording.faults).most_common(1)[0][0]
        n_stretches = len(recording.faults)
        problems.append(
            f"{n_stretches} stretches are no frame, most for {most}: {recording.faults[0]}"
        )
    problems += _sequence_problems(recording)
    for what, values, wanted in (
        ("dictionary hash", [f.dictionary_hash for f in recording.frames], bench.first.header_hash),
        ("session", [f.session for f in recording.frames], bench.first.session),
        ("version", [f.version for f in recording.frames], PROTOCOL_VERSION),
    ):
        others = [value for value in values if value != wanted]
        if others:
            problems.append(
                f"{len(others)} of {len(values)} frames carry {what} {others[0]:x}, "
                f"wanted {wanted:x}"
            )
    problems += _type_problems(recording)
    if problems:
        return failed(problems)
    return passed(f"{len(recording.frames)} frames, all whole and in order")


def _sequence_problems(recording: Recording) -> list[str]:
    sequences = [frame.sequence for frame in recording.frames]
    repeated = missing = n_jumps = 0
    for before, after in itertools.pairwise(sequences):
        gap = sequence_gap((before + 1) & 0xFFFFFFFF, after)
        repeated += gap < 0
        missing += max(gap, 0)
        n_jumps += gap > 0
    problems = []
    if repeated:
        problems.append(f"the sequence number does not rise in {repeated} frames")
    if missing:
        problems.append(f"{missing} frames are missing by their sequence number, in {n_jumps} gaps")
    return problems


def _type_problems(recording: Recording) -> list[str]:
    problems = []
    for frame in recording.frames:
        try:
            decoded = frame.frame()
            if frame.type == FrameType.STREAM:
                decode_samples(decoded)
        except FrameError as error:
            problems.append(f"frame {frame.sequence}: {error}")
    return problems


def check_samples(bench: BoardBench) -> Finding:
    """Step `samples`: every sample once; what is missing is owned up to."""
    recording = bench.recording()
    stream = recording.stream
    if not len(stream.first):
        return failed("no STREAM frame came")
    expected = np.concatenate(([0], (stream.first + stream.lengths)[:-1]))
    steps = stream.first - expected
    gaps, overlaps = steps[steps > 0], steps[steps < 0]
    dropped = recording.statuses[-1][0].stream_samples_dropped
    overruns = recording.statuses[-1][0].adc_overruns
    lost_frames = any("missing" in text for text in _sequence_problems(recording))
    problems = []
    if len(overlaps):
        problems.append(
            f"{len(overlaps)} frames bring samples again, {-int(overlaps.sum())} samples in all; "
            f"the first at index {int(stream.first[steps < 0][0])}"
        )
    if len(gaps):
        text = (
            f"the sample index jumps {len(gaps)} times, over {int(gaps.sum())} samples; first at "
            f"index {int(stream.first[steps > 0][0])}"
        )
        if overruns:
            problems.append(f"{text}; the converter lost samples {overruns} times")
        elif lost_frames:
            problems.append(f"{text}; frames were lost on the link")
        elif dropped != int(gaps.sum()):
            problems.append(f"{text}; STATUS owns up to {dropped}")
        else:
            problems.append(
                f"{text}; the board dropped them, as it says, in each of two runs: link or host "
                "are too slow"
            )
    problems += _count_problems(bench, recording)
    if problems:
        return failed(problems)
    n = int(stream.present.sum())
    return passed(f"{n} samples in {n / float(recording.configuration.rate_hz):.1f} s, each once")


def _count_problems(bench: BoardBench, recording: Recording) -> list[str]:
    """Compare next_sample of every STATUS with the samples due by the board's own ticks."""
    stream, rate_hz = recording.stream, float(recording.configuration.rate_hz)
    tick_hz = bench.dictionary.tick_hz
    begin = int(stream.ticks[0]) - round(int(stream.first[0]) * tick_hz / rate_hz)
    lag_s = STATUS_LAG_S + STATUS_LAG_WALL_S / bench.clock.wall_s(1.0)
    worst, at = 0.0, 0
    for status, trip in recording.statuses[1:]:
        due = (trip.ticks - begin) / tick_hz * rate_hz
        off_s = (status.next_sample - due) / rate_hz
        late_s = -off_s if off_s < 0 else off_s
        if late_s > lag_s + 1e-3 * due / rate_hz and late_s > worst:
            worst, at = late_s, status.next_sample
    if worst:
        return [
            (
                f"STATUS said next_sample {at}, which is {worst:.3f} s from what ticks and rate "
                "make due"
            )
        ]
    last = recording.statuses[-1][0].next_sample
    received = len(stream.present)
    behind_s = (last - received) / rate_hz
    if abs(behind_s) > lag_s + STATUS_LAG_S:
        return [
            f"STATUS counts {last} samples, the stream had come to {received} ({behind_s:+.3f} s)"
        ]
    return []


def _tick_rate(bench: BoardBench, recording: Recording) -> TickRate:
    trips = [trip for _, trip in recording.statuses]
    return tick_rate(trips, nominal_tick_hz=bench.dictionary.tick_hz)


def check_rate(bench: BoardBench) -> Finding:
    """Step `rate`: samples a second of the host's clock, by way of the board's ticks."""
    recording = bench.recording()
    stream = recording.stream
    if len(stream.first) < 2:
        return failed("fewer than two STREAM frames came")
    rate_hz, tick_hz = float(recording.configuration.rate_hz), bench.dictionary.tick_hz
    clock = _tick_rate(bench, recording)
    ticks = (stream.ticks - stream.ticks[0]).astype(np.int64).astype(np.float64)
    samples = (stream.first - stream.first[0]).astype(np.float64)
    if not samples[-1] > 0.0 or not ticks[-1] > 0.0:
        return failed("sample index and ticks of the STREAM frames do not rise")
    off_ticks = ticks - ticks[-1] / samples[-1] * samples
    residual_s = float(np.abs(off_ticks).max()) / tick_hz
    per_tick = tick_hz * samples[-1] / ticks[-1]  # Hz, were the ticks right
    off, bound = per_tick * (1.0 + clock.drift) / rate_hz - 1.0, clock.bound
    text = (
        f"{rate_hz * (1.0 + off):.6g} Hz, {1e6 * off:+.0f} ppm from {rate_hz:.6g} Hz, known to "
        f"{1e6 * bound:.0f} ppm"
    )
    problems = []
    if abs(off) > 1e-6 * CRYSTAL_PPM + bound:
        problems.append(text)
    # The straight line goes through the end points, whose own error may double another's.
    if residual_s > 2.0 * (LATCH_S + 1.0 / tick_hz):
        problems.append(
            f"ticks of STREAM frames are up to {1e6 * residual_s:.0f} us from an even sample clock"
        )
    return failed(problems) if problems else passed(text)


def check_clock(bench: BoardBench) -> Finding:
    """Step `clock`: the tick counter never runs backwards and keeps a crystal's rate."""
    recording = bench.recording()
    problems = []
    replies = [f for f in recording.frames if f.type < FrameType.STREAM]
    streams = [f for f in recording.frames if f.type == FrameType.STREAM]
    for what, frames in (("replies", replies), ("STREAM frames", streams)):
        back = sum(b.ticks < a.ticks for a, b in itertools.pairwise(frames))
        if back:
            problems.append(f"ticks run backwards {back} times among the {what}")
    clock = _tick_rate(bench, recording)
    text = (
        f"{1e6 * clock.drift:+.0f} ppm against the host, known to {1e6 * clock.bound:.0f} ppm "
        f"by {len(recording.statuses)} round trips"
    )
    if not clock.steady:
        problems.append("no steady clock agrees with all the round trips: the ticks jump")
    elif abs(clock.drift) > 1e-6 * CRYSTAL_PPM + clock.bound:
        problems.append(f"the clock drifts: {text}")
    if any(f.overflow & ~int(Overflow.STREAM | Overflow.BLOCK | Overflow.ADC) for f in replies):
        problems.append("overflow bits that section 3 does not list are set")
    if not problems and not clock.told:
        return unchecked(f"{text}: the line or this machine is too slow to tell; check again")
    return failed(problems) if problems else passed(text)
