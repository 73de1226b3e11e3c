"""24-bit counts and the frames that carry them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from armodal.protocols.board import (
    COUNT_MAX,
    COUNT_MIN,
    Frame,
    FrameType,
    Header,
    Samples,
    decode_samples,
    encode_samples,
    pack_counts,
    unpack_counts,
)
from armodal.protocols.errors import FrameError

COUNTS = arrays(
    np.int32,
    array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=12),
    elements=st.integers(COUNT_MIN, COUNT_MAX),
)


def frame(kind: FrameType, payload: bytes, first_sample: int = 0) -> Frame:
    return Frame(
        header=Header(type=kind, session=1, sequence=0, first_sample=first_sample), payload=payload
    )


@given(COUNTS)
def test_packing_is_the_three_low_bytes_of_each_count_in_sample_order(counts):
    by_hand = b"".join(int(c).to_bytes(3, "little", signed=True) for c in counts.ravel())
    assert pack_counts(counts) == by_hand


@given(COUNTS, st.integers(0, 5))
def test_counts_come_back_from_any_offset(counts, offset):
    found = unpack_counts(b"\xa5" * offset + pack_counts(counts), counts.shape[1], offset)
    assert found.dtype == np.int32
    assert found.flags.c_contiguous
    np.testing.assert_array_equal(found, counts)


def test_any_memory_order_and_integer_type_is_packed_alike():
    counts = np.arange(-6, 6, dtype=np.int32).reshape(3, 4)
    wide = np.asfortranarray(counts.astype(np.int64))
    assert pack_counts(wide) == pack_counts(counts[::-1][::-1]) == pack_counts(counts)


@pytest.mark.parametrize("count", [COUNT_MIN - 1, COUNT_MAX + 1])
def test_a_count_of_more_than_24_bits_is_refused(count):
    with pytest.raises(FrameError, match=str(count)):
        pack_counts(np.array([[count]], dtype=np.int32))


def test_bytes_that_are_no_whole_samples_are_refused():
    with pytest.raises(FrameError, match="whole number of samples of 6"):
        unpack_counts(bytes(9), 2)
    with pytest.raises(FrameError, match="at least one channel"):
        unpack_counts(b"", 0)
    assert unpack_counts(b"", 2).shape == (0, 2)


@given(COUNTS, st.none() | st.integers(1, 2**32 - 1), st.integers(0, 2**64 - 1))
def test_samples_survive_their_frame(counts, block_id, first_sample):
    kind = FrameType.STREAM if block_id is None else FrameType.BLOCK_DATA
    sent = Samples(first_sample=first_sample, counts=counts, block_id=block_id)
    found = decode_samples(frame(kind, encode_samples(sent), first_sample))
    assert (found.first_sample, found.block_id) == (first_sample, block_id)
    np.testing.assert_array_equal(found.counts, counts)
    assert not found.counts.flags.writeable


PREFIXES = st.tuples(st.integers(0, 3), st.just(0), st.integers(0, 3), st.integers(2, 4)).map(bytes)


@given(
    st.sampled_from([FrameType.STREAM, FrameType.BLOCK_DATA, FrameType.STOP]),
    st.binary(max_size=40) | st.builds(bytes.__add__, PREFIXES, st.binary(max_size=40)),
)
def test_any_sample_payload_decodes_or_raises_frame_error(kind, payload):
    try:
        samples = decode_samples(frame(kind, payload))
    except FrameError:
        return
    assert encode_samples(samples) == payload


def test_no_samples_are_no_frame():
    with pytest.raises(FrameError, match="at least one"):
        encode_samples(Samples(first_sample=0, counts=np.empty((0, 4), dtype=np.int32)))
