"""Trigger, pre-trigger, blocks and preview of the C board against the text of the document."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.c_device import C, Device, dictionary_of

from armodal.protocols.board import (
    BlockInfo,
    BoardState,
    Configuration,
    FrameType,
    Overflow,
    Release,
    Slope,
    decode_payload,
    decode_samples,
    encode_payload,
    samples_per_frame,
)


def wanted(before, length, level=0, slope=Slope.RISING, **changes):
    fields = {
        "rate_hz": Fraction(1024),
        "channel_mask": 3,
        "trigger_channel": 0,
        "trigger_level_counts": level,
        "slope": slope,
        "pretrigger": before,
        "block_length": length,
        "stream": False,
    }
    return Configuration(**(fields | changes))


def blocks_of(device):
    """(info, counts) of every block that was sent, whole and in order."""
    found, data = [], []
    for frame in device.frames:
        if frame.header.type is FrameType.BLOCK_READY:
            found.append((decode_payload(BlockInfo, frame.payload), data := []))
        elif frame.header.type is FrameType.BLOCK_DATA:
            samples = decode_samples(frame)
            assert samples.block_id == found[-1][0].block_id
            assert samples.first_sample == found[-1][0].first_sample + sum(map(len, data))
            data.append(samples.counts)
    return [(info, np.concatenate(data)) for info, data in found]


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
    buffers = data.draw(st.integers(1, 4))
    counts = np.stack([values, np.arange(len(values))], axis=1).astype(np.int32)
    device = Device(dictionary_of(block_capacity=buffers * length * 6 + 5))
    device.run(wanted(before, length, level, slope))
    position = 0
    while position < len(counts):
        n = data.draw(st.integers(1, 30))
        device.feed(counts[position : position + n], ticks=position)
        device.poll()
        position += n
    expected, missed = by_the_book(values, before, length, level, slope, buffers)
    found = blocks_of(device)
    assert [(info.first_sample, info.trigger_sample) for info, _ in found] == expected
    assert [info.block_id for info, _ in found] == list(range(1, len(found) + 1))
    status = device.status()
    assert (status.triggers_missed, status.buffered_blocks) == (missed, len(found))
    for info, block in found:
        first = info.first_sample
        np.testing.assert_array_equal(block, counts[first : first + length])


def test_the_last_sample_of_a_block_is_no_trigger_and_the_next_one_is():
    device = Device()
    device.run(wanted(0, 2, 1))
    device.feed([[0, 0], [1, 0], [0, 0], [1, 0], [0, 0], [1, 0]])
    device.poll()
    assert [info.trigger_sample for info, _ in blocks_of(device)] == [1, 3]


def test_a_block_never_has_a_hole():
    device = Device()
    device.run(wanted(2, 8, 5))
    device.feed([[0, 0], [0, 0], [9, 0], [0, 0]])
    C.ab_lost(device.board, 10)
    status = device.status()
    assert (status.triggers_missed, status.adc_overruns, status.next_sample) == (1, 1, 14)
    assert device.frames[-1].header.overflow == Overflow.BLOCK | Overflow.ADC
    later = [[value, i] for i, value in enumerate((9, 0, 9, 0, 9, 0, 0, 0, 0, 0))]
    device.feed(later)
    device.poll()
    # The first sample after the jump has none before it; the next crossing has its pre-trigger.
    ((info, counts),) = blocks_of(device)
    assert (info.first_sample, info.trigger_sample) == (14, 16)
    np.testing.assert_array_equal(counts, later[:8])


def test_a_buffer_freed_while_all_were_held_takes_a_block_once_its_pretrigger_is_there():
    device = Device(dictionary_of(block_capacity=6 * 6))  # one block of six samples
    device.run(wanted(3, 6, 1))
    device.feed([[0, 0], [0, 0], [0, 0], [1, 0], [0, 0], [0, 0]])
    device.feed([[0, 0]] * 10)
    device.poll()
    assert device.code(FrameType.RELEASE, encode_payload(Release(block_id=1))) == 0
    device.feed([[0, 0], [0, 0], [1, 0]])  # only two samples before it
    assert device.status().triggers_missed == 1
    # The crossing is passed over for as long as its block would have lasted, three samples more.
    device.feed([[0, 0], [1, 0], [0, 0], [1, 7], [0, 0], [0, 0]])
    device.poll()
    infos = [info for info, _ in blocks_of(device)]
    assert [(info.block_id, info.trigger_sample) for info in infos] == [(1, 3), (2, 22)]


def test_after_a_missed_trigger_crossings_count_again_once_its_block_would_have_ended():
    device = Device(dictionary_of(block_capacity=6 * 4))  # one block of four samples
    device.run(wanted(1, 4, 1))
    # Blocks from 1 (held), from 5 (missed, until 8) and from 8 (missed).
    device.feed([[value, 0] for value in (0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0)])
    assert device.status().triggers_missed == 2


def test_no_sample_is_compared_with_one_before_a_jump():
    device = Device()
    device.run(wanted(0, 3, 1))
    device.feed([[0, 0]])
    C.ab_lost(device.board, 5)
    device.feed([[1, 0], [0, 0], [1, 0], [0, 0], [0, 0]])
    device.poll()
    assert [info.trigger_sample for info, _ in blocks_of(device)] == [8]


def test_the_pretrigger_of_a_block_may_lie_in_the_block_before():
    device = Device()
    device.run(wanted(6, 8, 1))
    values = [0] * 6 + [1, 0] + [1] + [0] * 5
    counts = [[value, i] for i, value in enumerate(values)]
    device.feed(counts)
    device.poll()
    (_, first), (info, second) = blocks_of(device)
    assert info.first_sample == 2
    np.testing.assert_array_equal(first, counts[:8])
    np.testing.assert_array_equal(second, counts[2:10])


def test_a_stopped_run_gives_up_its_open_block_without_counting_it():
    device = Device()
    device.run(wanted(0, 10, 1))
    device.feed([[0, 0], [1, 0], [0, 0]])
    assert device.code(FrameType.STOP) == 0
    assert device.calls == [(1024, 1), ("stop",)]
    status = device.status()
    assert (status.triggers_missed, status.buffered_blocks) == (0, 0)
    assert status.state is BoardState.CONFIGURED
    device.feed([[0, 0]] * 20)
    assert device.status().next_sample == 3


def test_ids_go_on_after_start_and_counts_do_not():
    device = Device(dictionary_of(block_capacity=6))
    device.run(wanted(0, 1, 1))
    device.feed([[0, 0], [1, 0], [0, 0], [1, 0]])
    assert device.status().triggers_missed == 1
    device.code(FrameType.STOP)
    device.code(FrameType.START)
    assert device.frames[-1].header.overflow is Overflow.NONE
    assert device.status().triggers_missed == device.status().buffered_blocks == 0
    device.feed([[0, 0], [1, 0]])
    device.poll()
    assert blocks_of(device)[-1][0].block_id == 2
    # An id of the run before is held no longer, but was given out.
    assert device.code(FrameType.RELEASE, encode_payload(Release(block_id=1))) == 0


def test_ticks_are_counted_on_from_the_tick_of_the_first_sample_of_a_portion():
    # 51200/31 Hz and a 1 MHz clock: 605.46875 ticks a sample.
    period = Fraction(1_000_000 * 31, 51_200)
    device = Device()
    device.run(wanted(100, 300, 1, rate_hz=Fraction(51_200, 31), stream=True))
    counts = np.zeros((1000, 2), dtype=np.int32)
    counts[250] = 1
    for first in range(0, 1000, 200):
        device.feed(counts[first : first + 200], ticks=5_000 + round(first * period))
        device.poll()
    for frame in device.of(FrameType.STREAM) + device.of(FrameType.BLOCK_DATA):
        # Two roundings: of the tick handed over, and of the ticks counted on from it.
        assert abs(frame.header.ticks - 5_000 - frame.header.first_sample * period) <= 2
    ((info, _),) = blocks_of(device)
    assert abs(info.trigger_ticks - 5_000 - 250 * period) <= 2


@pytest.mark.parametrize("n_channels", [1, 4, 11, 32])
def test_any_number_of_channels_fits_its_frames(n_channels):
    device = Device(dictionary_of(n_channels))
    length = samples_per_frame(n_channels) * 2 + 3
    mask = (1 << n_channels) - 1
    device.run(wanted(1, length, 1, channel_mask=mask, stream=True, rate_hz=Fraction(51_200)))
    rng = np.random.default_rng(n_channels)
    counts = rng.integers(-(2**23), 0, (3 * length, n_channels))
    counts[1, 0] = 1
    device.feed(counts)
    device.poll()
    ((_, block),) = blocks_of(device)
    np.testing.assert_array_equal(block, counts[:length])
    stream = np.concatenate([decode_samples(f).counts for f in device.of(FrameType.STREAM)])
    np.testing.assert_array_equal(stream, counts[: len(stream)])
    assert len(stream) > 3 * length - samples_per_frame(n_channels)


def test_only_the_channels_of_the_mask_are_sent():
    device = Device(dictionary_of(5))
    device.run(wanted(0, 4, 1, channel_mask=0b10110, trigger_channel=4))
    counts = np.arange(50).reshape(10, 5) - 9
    device.feed(counts)
    device.poll()
    ((info, block),) = blocks_of(device)
    assert info.trigger_sample == 2  # channel 4 carries -5, 0, 5, ...
    np.testing.assert_array_equal(block, counts[2:6, [1, 2, 4]])


def test_a_preview_without_room_drops_whole_frames_and_counts_them():
    device = Device(preview_frames=2)
    device.run(wanted(0, 4, 1, stream=True, rate_hz=Fraction(51_200)))
    counts = np.zeros((64, 2), dtype=np.int32)
    counts[:, 1] = np.arange(64)
    device.room = 0
    for _ in range(10):
        device.feed(counts)
        device.poll()
    device.room = None
    device.poll()
    device.feed(counts)
    device.poll()
    status = device.status()
    streamed = [decode_samples(frame) for frame in device.of(FrameType.STREAM)]
    # One frame was in the transmit buffer, two in the preview's; the last came after the jam.
    assert [s.first_sample for s in streamed] == [0, 64, 128, 640]
    assert status.stream_samples_dropped == 7 * 64
    assert device.frames[-1].header.overflow is Overflow.STREAM
    numbers = [frame.header.sequence for frame in device.frames]
    assert [b - a for a, b in itertools.pairwise(numbers)] == [1] * (len(numbers) - 1)


def test_a_frame_cut_short_by_a_jump_is_dropped_with_as_many_samples_as_it_has():
    device = Device(preview_frames=1)
    device.run(wanted(0, 4, 1, stream=True, rate_hz=Fraction(51_200)))
    device.room = 0
    # One frame goes to the transmit buffer, one to the preview's; then 10 samples find no room.
    device.feed([[0, 0]] * (64 + 64 + 10))
    C.ab_lost(device.board, 1)
    device.room = None
    assert device.status().stream_samples_dropped == 10


def test_what_is_held_outlives_configure_refused_and_not_configure_accepted():
    device = Device()
    device.run(wanted(0, 1, 1))
    device.feed([[0, 0], [1, 0]])
    device.code(FrameType.STOP)
    assert device.code(FrameType.CONFIGURE, encode_payload(wanted(5, 5))) == 1
    assert device.status().buffered_blocks == 1
    assert device.code(FrameType.CONFIGURE, encode_payload(wanted(4, 5))) == 0
    assert device.status().buffered_blocks == 0
