from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from armodal.daq.preview import MOST_BYTES, StreamWatch
from armodal.protocols.board.messages import encode_samples
from armodal.protocols.board.records import Frame, FrameType, Header, Samples


def frame(first: int, counts: np.ndarray) -> Frame:
    header = Header(type=FrameType.STREAM, session=1, sequence=0, first_sample=first)
    return Frame(header=header, payload=encode_samples(Samples(first_sample=first, counts=counts)))


def test_the_envelope_hides_no_peak():
    rng = np.random.default_rng(1)
    counts = rng.integers(-100, 100, (6400, 4)).astype(np.int32)
    counts[1234, 2] = 8_000_000
    counts[4321, 0] = -8_000_000
    watch = StreamWatch(4)
    for first in range(0, 6400, 64):
        watch.add(frame(first, counts[first : first + 64]))
    preview = watch.preview()
    assert preview is not None
    assert preview.n_samples == 6400
    np.testing.assert_array_equal(preview.highest.max(axis=0), counts.max(axis=0))
    np.testing.assert_array_equal(preview.lowest.min(axis=0), counts.min(axis=0))
    assert watch.preview() is None


@given(lost=st.sets(st.integers(1, 48)))
def test_missing_samples_are_counted_by_their_index(lost):
    watch = StreamWatch(1)
    for k in range(50):
        if k not in lost:
            watch.add(frame(64 * k, np.zeros((64, 1), dtype=np.int32)))
    assert watch.missing == 64 * len(lost)


@given(payload=st.binary(max_size=40))
def test_any_payload_is_taken_or_counted(payload):
    watch = StreamWatch(4)
    header = Header(type=FrameType.STREAM, session=1, sequence=0)
    watch.add(Frame(header=header, payload=payload))
    assert (watch.samples > 0) != (watch.malformed > 0)


def test_what_is_kept_for_the_envelope_is_bounded():
    watch = StreamWatch(4)
    counts = np.zeros((64, 4), dtype=np.int32)
    for k in range(3000):
        watch.add(frame(64 * k, counts))
    preview = watch.preview()
    assert preview is not None
    assert preview.n_samples * 12 <= MOST_BYTES
    assert watch.samples == 64 * 3000


def test_what_is_missing_at_the_very_start_is_counted():
    watch = StreamWatch(4)
    counts = np.zeros((8, 4), dtype=np.int32)
    payload = encode_samples(Samples(first_sample=16, counts=counts))
    header = Header(type=FrameType.STREAM, session=1, sequence=0, first_sample=16)
    watch.add(Frame(header=header, payload=payload))
    assert (watch.samples, watch.missing, watch.expected) == (8, 16, 24)
