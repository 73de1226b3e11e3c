from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hil_sim.capture import BlockCapture
from protocols.board.records import Configuration, Slope


def configuration(before, length, level, slope):
    return Configuration(
        rate_hz=Fraction(1024),
        channel_mask=3,
        trigger_channel=0,
        trigger_level_counts=level,
        slope=slope,
        pretrigger=before,
        block_length=length,
        stream=False,
    )


def by_the_book(values, before, length, level, slope, buffers):
    """Blocks (first, trigger) and misses, sample by sample as section 8 tells it."""
    blocks, missed, busy_until = [], 0, 0
    for i in range(1, len(values)):
        if slope is Slope.RISING:
            crosses = values[i - 1] < level <= values[i]
        else:
            crosses = values[i - 1] > level >= values[i]
        if not crosses or i < before or i < busy_until:
            continue
        busy_until = i - before + length
        if len(blocks) < buffers:
            blocks.append((i - before, i))
        else:
            missed += 1
    return [b for b in blocks if b[0] + length <= len(values)], missed


@given(data=st.data())
def test_blocks_are_those_of_the_specification_however_samples_arrive(data):
    values = data.draw(st.lists(st.integers(-3, 3), min_size=1, max_size=120))
    length = data.draw(st.integers(1, 20))
    before = data.draw(st.integers(0, length - 1))
    level = data.draw(st.integers(-2, 2))
    slope = data.draw(st.sampled_from(Slope))
    buffers = data.draw(st.integers(0, 4))
    counts = np.stack([values, np.arange(len(values))], axis=1).astype(np.int32)
    capture = BlockCapture(
        configuration(before, length, level, slope), n_channels=2, trigger_column=0
    )
    blocks, position = [], 0
    while position < len(counts):
        n = data.draw(st.integers(1, 30))
        blocks += capture.feed(counts[position : position + n], buffers - len(blocks))
        position += n
    expected, missed = by_the_book(values, before, length, level, slope, buffers)
    assert [(b.first_sample, b.trigger_sample) for b in blocks] == expected
    assert capture.missed == missed
    for block in blocks:
        first = block.first_sample
        np.testing.assert_array_equal(block.counts, counts[first : first + length])


def test_a_block_never_has_a_hole():
    capture = BlockCapture(configuration(2, 8, 5, Slope.RISING), n_channels=1, trigger_column=0)
    pulse = np.array([[0], [0], [9], [0]], dtype=np.int32)
    assert capture.feed(pulse, 1) == []
    capture.lose(10)
    assert capture.missed == 1
    assert capture.next_sample == 14
    later = np.array([[9], [0], [9], [0], [9], [0], [0], [0], [0], [0]], dtype=np.int32)
    blocks = capture.feed(later, 1)
    # The first sample after the jump has none before it; the next crossing has its pre-trigger.
    assert [(b.first_sample, b.trigger_sample) for b in blocks] == [(14, 16)]
    np.testing.assert_array_equal(blocks[0].counts, later[:8])
