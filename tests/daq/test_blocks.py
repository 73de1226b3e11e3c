from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from armodal.daq.blocks import BlockAssembler, BlockCollector
from armodal.protocols.board.records import BlockInfo, Samples

LENGTH = 100
FIRST = 5000


def info(block_id: int = 1, length: int = LENGTH) -> BlockInfo:
    return BlockInfo(
        block_id=block_id,
        first_sample=FIRST,
        length=length,
        trigger_sample=FIRST + 10,
        trigger_ticks=0,
    )


COUNTS = np.arange(2 * LENGTH, dtype=np.int32).reshape(LENGTH, 2)


def part(start: int, end: int, block_id: int = 1) -> Samples:
    return Samples(first_sample=FIRST + start, counts=COUNTS[start:end], block_id=block_id)


PARTS = st.lists(
    st.tuples(st.integers(0, LENGTH - 1), st.integers(1, 40)).map(
        lambda p: (p[0], min(p[0] + p[1], LENGTH))
    ),
    max_size=12,
)


@given(parts=PARTS)
def test_any_order_and_overlap_gives_true_samples_and_the_true_holes(parts):
    block = BlockAssembler(info(), 2, 0.0)
    present = np.zeros(LENGTH, dtype=bool)
    for start, end in parts:
        assert block.add(part(start, end), 0.0)
        present[start:end] = True
    holes = np.ones(LENGTH, dtype=bool)
    for first, count in block.missing():
        assert not present[first : first + count].any()
        holes[first : first + count] = False
    np.testing.assert_array_equal(holes, present)
    captured = block.captured()
    start = captured.first_sample - FIRST
    n = len(captured.counts)
    assert captured.missing == LENGTH - n
    np.testing.assert_array_equal(captured.counts, COUNTS[start : start + n])
    assert block.complete == present.all()


def test_samples_outside_the_block_are_not_taken():
    block = BlockAssembler(info(), 2, 0.0)
    outside = Samples(first_sample=FIRST + 90, counts=COUNTS[:20], block_id=1)
    other_shape = Samples(first_sample=FIRST, counts=COUNTS[:5, :1], block_id=1)
    assert not block.add(outside, 0.0)
    assert not block.add(other_shape, 0.0)
    assert block.missing() == ((0, LENGTH),)


def collector(**changes: int) -> BlockCollector:
    return BlockCollector(2, block_length=LENGTH, resend_after_s=0.2, **changes)


def test_holes_are_asked_for_after_a_silence_and_a_bounded_number_of_times():
    blocks = collector(max_rounds=2)
    blocks.announce(info(), 0.0)
    blocks.add(part(0, 40), 0.0)
    blocks.add(part(60, 100), 0.0)
    assert blocks.overdue(0.1) == ()
    asked = 0
    now_s = 0.0
    while blocks.take(now_s) is None:
        now_s += 0.05
        for wanted in blocks.overdue(now_s):
            assert (wanted.first, wanted.count) == (40, 20)
            asked += 1
    assert asked == 2
    assert now_s < 1.0


@given(
    lost=st.lists(
        st.sets(st.integers(0, LENGTH // 2 - 1), min_size=1, max_size=30), min_size=1, max_size=4
    )
)
def test_every_missing_stretch_of_every_block_is_asked_for_each_round_and_eight_at_a_time(lost):
    blocks = collector(max_rounds=4)
    for block_id, pieces in enumerate(lost, 1):
        blocks.announce(info(block_id), 0.0)
        for k in set(range(LENGTH // 2)) - pieces:
            blocks.add(part(2 * k, 2 * k + 2, block_id), 0.0)
    asked = {block_id: np.zeros(LENGTH, dtype=int) for block_id in range(1, len(lost) + 1)}
    out: list[int] = []
    times: list[float] = []
    for turn in range(20_000):
        now_s = 0.01 * turn
        for wanted in blocks.overdue(now_s):
            asked[wanted.block_id][wanted.first : wanted.first + wanted.count] += 1
            times.append(now_s)
        while (captured := blocks.take(now_s)) is not None:
            out.append(captured.info.block_id)
    assert out == sorted(asked)
    for block_id, pieces in enumerate(lost, 1):
        missing = np.isin(np.arange(LENGTH) // 2, list(pieces))
        np.testing.assert_array_equal(asked[block_id], 4 * missing)
    # A board's queue takes eight: the ninth comes no sooner than the time for an answer.
    assert all(late - soon > 0.19 for soon, late in zip(times, times[8:], strict=False))


def test_a_block_is_handed_out_once():
    blocks = collector()
    assert blocks.announce(info(), 0.0)
    blocks.add(part(0, LENGTH), 0.0)
    captured = blocks.take(0.0)
    assert captured is not None
    assert captured.missing == 0
    assert blocks.take(0.0) is None
    assert not blocks.announce(info(), 0.0)


def test_memory_is_bounded_by_blocks_and_length():
    blocks = collector(max_blocks=2)
    assert not blocks.announce(info(1, length=LENGTH * 1000), 0.0)
    assert [blocks.announce(info(i), 0.0) for i in (1, 2, 3)] == [True, True, False]
    assert not blocks.knows(3)


def test_data_of_a_block_nobody_announced_is_counted():
    blocks = collector()
    blocks.add(part(0, 10, block_id=9), 0.0)
    assert blocks.foreign_frames == 1
