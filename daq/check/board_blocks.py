"""Steps: blocks are cut where they should be, and the board holds what it sent."""

from __future__ import annotations

import numpy as np

from armodal.daq.check.board_bench import BoardBench
from armodal.daq.check.captured import (
    BLOCK_LENGTH,
    PRETRIGGER,
    Capture,
    Level,
    SentBlock,
    blocks_of,
    capture,
    noise_level,
    whole_blocks,
)
from armodal.daq.check.probe import BoardProbe, BoardStepError
from armodal.daq.check.trigger_truth import expected_blocks
from armodal.daq.check.verdict import Finding, failed, passed, unchecked
from armodal.protocols.board.messages import (
    encode_payload,
)
from armodal.protocols.board.records import (
    FrameType,
    Release,
    ReplyCode,
    Resend,
    Slope,
)

__all__ = ["TOO_QUIET", "check_pretrigger", "check_resend", "check_trigger", "hold_a_block"]

LATCH_S = 10e-6  # section 3
LARGEST_SHIFT = 64  # samples looked for between a block and the preview
RESEND_WAIT_S = 0.5
RESEND_TRIES = 3
RANGES = ((0, BLOCK_LENGTH), (0, 1), (BLOCK_LENGTH - 1, 1), (13, 101), (0, 0))
QUEUE = 8  # ranges the board's queue takes at least, section 8

TOO_QUIET = (
    "every channel is quieter than one count, so no trigger level lies within the noise: connect "
    "a sensor, or feed a small signal"
)


def _captures(bench: BoardBench) -> list[Capture] | None:
    level = noise_level(bench)
    if level is None:
        return None
    return [capture(bench, level, slope) for slope in (Slope.RISING, Slope.FALLING)]


def check_trigger(bench: BoardBench) -> Finding:
    """Step `trigger`: the trigger sample is where the level is crossed, and its time is right."""
    captures = _captures(bench)
    if captures is None:
        return unchecked(TOO_QUIET)
    problems = []
    n_compared = 0
    for taken in captures:
        for block in taken.blocks:
            problems += _trigger_problems(taken, block)
        problems += _tick_problems(bench, taken)
        compared, unlike = _unlike_preview(taken)
        n_compared += compared
        problems += unlike
    if problems:
        return failed(problems)
    n_blocks = sum(len(taken.blocks) for taken in captures)
    level = captures[0].configuration.trigger_level_counts
    return passed(
        f"{n_blocks} blocks at {level} counts on channel {captures[0].column}, rising and "
        f"falling; {n_compared} of them are the triggers the preview asks for"
    )


def _trigger_problems(taken: Capture, block: SentBlock) -> list[str]:
    info, configuration = block.info, taken.configuration
    name = f"block {info.block_id}"
    if info.length != configuration.block_length:
        return [f"{name}: {configuration.block_length} samples configured, {info.length} announced"]
    if block.samples != info.length or not block.in_order or block.pieces[0][0] != 0:
        return [f"{name}: {block.samples} of {info.length} samples came, or not in order"]
    at = info.trigger_sample - info.first_sample
    if at == 0:
        return []
    before, after = block.counts[at - 1 : at + 1, taken.column].tolist()
    level = configuration.trigger_level_counts
    rising = configuration.slope is Slope.RISING
    if (before < level <= after) if rising else (before > level >= after):
        return []
    word = "rising" if rising else "falling"
    return [
        (
            f"{name}: at its trigger sample {info.trigger_sample} the counts go from {before} to "
            f"{after}, which is no {word} crossing of {level}"
        )
    ]


def _tick_problems(bench: BoardBench, taken: Capture) -> list[str]:
    stream, tick_hz = taken.stream, bench.dictionary.tick_hz
    if not len(stream.first):
        return []
    tolerance = 2.0 * (LATCH_S * tick_hz + 1.0)
    period = tick_hz / float(taken.configuration.rate_hz)
    for block in taken.blocks:
        # The nearest preview frame: over a short way a drifting sample clock makes no difference.
        nearest = int(np.abs(stream.first - block.info.trigger_sample).argmin())
        samples = block.info.trigger_sample - int(stream.first[nearest])
        due = int(stream.ticks[nearest]) + samples * period
        off = block.info.trigger_ticks - due
        if abs(off) > tolerance + 1e-3 * period * abs(samples):
            return [
                (
                    f"block {block.info.block_id}: trigger_ticks are {1e6 * off / tick_hz:+.0f} us "
                    "from the trigger sample's place in the preview"
                )
            ]
    return []


def _unlike_preview(taken: Capture) -> tuple[int, list[str]]:
    """Compare the triggers with those that the preview, as far as it is whole, asks for."""
    known = taken.stream.unbroken
    configuration = taken.configuration
    expected = expected_blocks(
        taken.stream.counts[:known, taken.column],
        level=configuration.trigger_level_counts,
        slope=configuration.slope,
        pretrigger=configuration.pretrigger,
        length=configuration.block_length,
    ).held
    sent = [block.info.trigger_sample for block in taken.blocks]
    # A block whose pre-trigger is wrong may end elsewhere: only the first is then sure to agree.
    pairs = [(e, s) for e, s in zip(expected, sent, strict=False) if max(e, s) < known]
    for wanted, came in pairs:
        if wanted != came:
            return len(pairs), [f"the preview calls for a trigger at sample {wanted}, not {came}"]
    return len(pairs), []


def check_pretrigger(bench: BoardBench) -> Finding:
    """Step `pretrigger`: as many samples before the trigger as configured, and the right ones."""
    captures = _captures(bench)
    if captures is None:
        return unchecked(TOO_QUIET)
    problems = []
    n_compared = 0
    for taken in captures:
        for block in taken.blocks:
            before = block.info.trigger_sample - block.info.first_sample
            if before != PRETRIGGER:
                problems.append(
                    f"block {block.info.block_id}: {PRETRIGGER} samples before the trigger "
                    f"wanted, {before} came"
                )
            same = _same_as_preview(taken, block)
            n_compared += same is not None
            if same:
                problems.append(same)
    if problems:
        return failed(problems)
    return passed(
        f"{PRETRIGGER} samples before the trigger; {n_compared} blocks are the preview's, count "
        "for count"
    )


def _same_as_preview(taken: Capture, block: SentBlock) -> str | None:
    """Return what differs, "" for nothing, None where the preview has a hole."""
    if not block.pieces:
        return None
    first, counts = block.info.first_sample, block.counts
    if _shifted(taken, first, counts) is None:
        return None
    if _shifted(taken, first, counts):
        return ""
    for shift in sorted(range(-LARGEST_SHIFT, LARGEST_SHIFT + 1), key=abs):
        if _shifted(taken, first + shift, counts):
            return (
                f"block {block.info.block_id} holds the samples from {first + shift} on, not those "
                f"from {first} on that it announces"
            )
    return f"block {block.info.block_id} is not what the preview brought from sample {first} on"


def _shifted(taken: Capture, first: int, counts: np.ndarray) -> bool | None:
    window = slice(first, first + len(counts))
    present = taken.stream.present[window]
    if first < 0 or len(present) < len(counts) or not present.all():
        return None
    return bool(np.array_equal(taken.stream.counts[window], counts))


def hold_a_block(bench: BoardBench, level: Level) -> SentBlock:
    """Start a run, and return its first block, which the board still holds; the run goes on.

    Raises
    ------
    BoardStepError
        If none comes.
    """
    configuration = bench.configuration(
        bench.rate_hz,
        trigger_channel=level.channel,
        trigger_level_counts=level.level,
        pretrigger=PRETRIGGER,
        block_length=BLOCK_LENGTH,
    )
    bench.probe.begin(configuration)
    wait_s = max(1.0 / bench.clock.wall_s(1.0), 10.0)
    if not bench.probe.collect(wait_s, lambda: whole_blocks(bench.probe) > 0):
        raise BoardStepError("no whole block came")
    return next(b for b in blocks_of(bench.probe.frames) if b.samples >= b.info.length)


def resent(
    bench: BoardBench, block: SentBlock, first: int, count: int
) -> tuple[SentBlock | None, str]:
    """Ask for a range again; return what came, or what is wrong."""
    probe = bench.probe
    block_id = block.info.block_id
    wait_s = probe.patience_s(RESEND_WAIT_S)
    for _ in range(RESEND_TRIES):
        probe.clear()
        code, reason = probe.code(
            FrameType.RESEND, encode_payload(Resend(block_id=block_id, first=first, count=count))
        )
        if code is not ReplyCode.OK:
            return None, f"refused: {code.name} {reason}".rstrip()

        def there() -> bool:
            return any(b.samples >= count for b in _of(probe, block_id))

        if probe.collect(wait_s, there):
            return _of(probe, block_id)[-1], ""
    return None, f"did not come in {RESEND_TRIES} tries"


def _of(probe: BoardProbe, block_id: int) -> list[SentBlock]:
    ready = next((i for i, f in enumerate(probe.frames) if f.type == FrameType.BLOCK_READY), None)
    if ready is None:
        return []
    return [b for b in blocks_of(probe.frames[ready:]) if b.info.block_id == block_id]


def compare_resent(bench: BoardBench, block: SentBlock, first: int, count: int) -> str:
    """Ask for a range again and return what differs from its first sending, "" for nothing."""
    what = f"samples {first}...{first + count - 1}" if count else "BLOCK_READY alone"
    again, problem = resent(bench, block, first, count)
    if again is None:
        return f"{what}: {problem}"
    if again.info != block.info:
        return f"{what}: BLOCK_READY differs from the first one"
    if count == 0:
        return "" if not again.pieces else f"{what}: {again.samples} samples came with it"
    if again.pieces[0][0] != first or again.samples != count or not again.in_order:
        return f"{what}: {again.samples} samples from {again.pieces[0][0]} on came"
    differing = int((again.counts != block.counts[first : first + count]).any(axis=1).sum())
    return f"{what}: {differing} samples differ from the first sending" if differing else ""


def check_resend(bench: BoardBench) -> Finding:
    """Step `resend`: ranges of a held block come again, the same to the bit, until it is freed."""
    level = noise_level(bench)
    if level is None:
        return unchecked(TOO_QUIET)
    block = hold_a_block(bench, level)
    probe, block_id = bench.probe, block.info.block_id
    probe.want_ok(FrameType.STOP)
    probe.settle()
    # What was under way before STOP may have been block data of others.
    problems = [
        text for first, count in RANGES if (text := compare_resent(bench, block, first, count))
    ]
    problems += _queue_problems(bench, block_id)
    n = BLOCK_LENGTH
    for payload, wanted, what in (
        (
            encode_payload(Resend(block_id=block_id, first=n - 1, count=2)),
            ReplyCode.BAD_VALUE,
            "a range that leaves the block",
        ),
        (
            encode_payload(Resend(block_id=0xFFFF_FFF0, first=0, count=1)),
            ReplyCode.UNKNOWN_BLOCK,
            "a block that never was",
        ),
    ):
        code, _ = probe.code(FrameType.RESEND, payload)
        if code is not wanted:
            problems.append(f"RESEND of {what}: {wanted.name} wanted, got {code.name}")
    for time in ("first", "second"):
        code, _ = probe.code(FrameType.RELEASE, encode_payload(Release(block_id=block_id)))
        if code is not ReplyCode.OK:
            problems.append(f"the {time} RELEASE of a block: OK wanted, got {code.name}")
    code, _ = probe.code(
        FrameType.RESEND, encode_payload(Resend(block_id=block_id, first=0, count=1))
    )
    if code is not ReplyCode.UNKNOWN_BLOCK:
        problems.append(f"RESEND of a released block: UNKNOWN_BLOCK wanted, got {code.name}")
    if problems:
        return failed(problems)
    return passed(f"{len(RANGES)} ranges of block {block_id} came again as first sent")


def _queue_problems(bench: BoardBench, block_id: int) -> list[str]:
    """Ask for the whole block eight times without waiting for the data: all are to come."""
    probe = bench.probe
    probe.clear()
    whole = encode_payload(Resend(block_id=block_id, first=0, count=BLOCK_LENGTH))
    codes = [probe.code(FrameType.RESEND, whole)[0] for _ in range(QUEUE)]
    if any(code is not ReplyCode.OK for code in codes):
        refused = next(code for code in codes if code is not ReplyCode.OK)
        return [f"one of {QUEUE} RESENDs in a row was refused with {refused.name}"]

    def sent() -> list[SentBlock]:
        return [b for b in blocks_of(probe.frames) if b.samples == BLOCK_LENGTH]

    wait_s = probe.patience_s(RESEND_WAIT_S)
    probe.collect(QUEUE * wait_s, lambda: len(sent()) == QUEUE)
    n_lost = QUEUE - len(sent())
    probe.settle()
    return [f"of {QUEUE} RESENDs in a row {n_lost} were not carried out whole"] if n_lost else []


def released_all(bench: BoardBench, block_ids: list[int]) -> None:
    """Free blocks.

    Raises
    ------
    BoardStepError
        If one cannot be freed.
    """
    for block_id in block_ids:
        code, reason = bench.probe.code(
            FrameType.RELEASE, encode_payload(Release(block_id=block_id))
        )
        if code is not ReplyCode.OK:
            raise BoardStepError(f"RELEASE of block {block_id}: {code.name} {reason}".rstrip())
