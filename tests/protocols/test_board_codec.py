"""Frames, the decoder and the sequence check."""

import zlib

import pytest
from cobs import cobs
from hypothesis import given
from hypothesis import strategies as st
from support.kept_memory import kept_bytes

from armodal.protocols.board import (
    HEADER_SIZE,
    MAX_PAYLOAD,
    Frame,
    FrameDecoder,
    FrameType,
    Header,
    Overflow,
    SequenceTracker,
    decode_frame,
    encode_frame,
    sequence_gap,
    wire_size,
)
from armodal.protocols.errors import FrameError

U16, U32, U64 = (st.integers(0, 2**bits - 1) for bits in (16, 32, 64))
HEADERS = st.builds(
    Header,
    type=st.sampled_from(FrameType),
    session=U32,
    sequence=U32,
    dictionary_hash=U16,
    overflow=st.integers(0, 7).map(Overflow),
    tag=U16,
    first_sample=U64,
    ticks=U64,
)
FRAMES = st.builds(Frame, header=HEADERS, payload=st.binary(max_size=300))
# Mostly delimiters and code bytes of short blocks, which is where COBS decoders go wrong.
NOISE = st.one_of(
    st.binary(max_size=200),
    st.lists(st.sampled_from([0, 1, 2, 3, 255]), max_size=200).map(bytes),
)


def header(sequence: int = 0, **fields: int) -> Header:
    return Header(type=FrameType.STATUS, session=1, sequence=sequence, **fields)


def wire(frame: Frame) -> bytes:
    return encode_frame(frame.header, frame.payload)


@given(FRAMES)
def test_a_frame_survives_the_wire(frame):
    encoded = wire(frame)
    assert encoded[0] == encoded[-1] == 0
    assert 0 not in encoded[1:-1]
    assert len(encoded) <= wire_size(len(frame.payload))
    assert decode_frame(encoded[1:-1]) == frame


def test_the_longest_payload_passes_and_one_byte_more_is_refused():
    payload = b"\xff" * MAX_PAYLOAD
    assert FrameDecoder().feed(encode_frame(header(), payload))[0].payload == payload
    with pytest.raises(FrameError, match="2048"):
        encode_frame(header(), payload + b"\xff")


@pytest.mark.parametrize("field", ["dictionary_hash", "tag", "first_sample", "ticks"])
@pytest.mark.parametrize("value", [-1, 2**64])
def test_a_header_field_that_does_not_fit_is_refused(field, value):
    with pytest.raises(FrameError, match="does not fit"):
        encode_frame(header(**{field: value}))


@given(NOISE)
def test_any_bytes_decode_or_raise_frame_error(data):
    try:
        frame = decode_frame(data)
    except FrameError:
        return
    assert decode_frame(wire(frame)[1:-1]) == frame


@given(st.binary(max_size=100) | st.binary(max_size=100).map(lambda rest: b"\x01\x90" + rest))
def test_any_body_with_a_right_crc_decodes_or_raises_frame_error(body):
    sealed = body + zlib.crc32(body).to_bytes(4, "little")
    try:
        frame = decode_frame(cobs.encode(sealed))
    except FrameError:
        return
    assert frame.payload == body[HEADER_SIZE:]


@given(st.data())
def test_a_changed_byte_never_gives_another_frame(data):
    frame = data.draw(FRAMES)
    encoded = bytearray(wire(frame)[1:-1])
    at = data.draw(st.integers(0, len(encoded) - 1))
    encoded[at] ^= data.draw(st.integers(1, 255))
    # A CRC-32 detects every burst of at most 32 bits; a changed code byte moves a zero, which
    # changes two bytes further apart and slips through once in 2^32.
    with pytest.raises(FrameError):
        decode_frame(bytes(encoded))


@given(st.lists(FRAMES, max_size=5), st.lists(NOISE, min_size=6, max_size=6), st.data())
def test_the_decoder_finds_every_frame_between_noise_however_the_stream_is_cut(frames, noise, data):
    # A delimiter ends each stretch of noise, as the leading one of every frame does.
    stream = noise[0] + b"".join(
        wire(frame) + after for frame, after in zip(frames, noise[1:], strict=False)
    )
    decoder = FrameDecoder()
    found = []
    while stream:
        size = data.draw(st.integers(1, len(stream)))
        found += decoder.feed(stream[:size])
        stream = stream[size:]
    assert found == frames
    assert decoder.frames == len(frames)


@given(st.lists(NOISE, max_size=8))
def test_what_the_decoder_counts_does_not_depend_on_the_portions(portions):
    whole, cut = FrameDecoder(), FrameDecoder()
    whole.feed(b"".join(portions) + b"\x00")
    for portion in [*portions, b"\x00"]:
        cut.feed(portion)
    assert (whole.bad_frames, whole.garbage_bytes) == (cut.bad_frames, cut.garbage_bytes)


def test_a_stream_without_delimiter_is_counted_once_and_not_kept():
    decoder = FrameDecoder()

    def stream():
        for _ in range(1000):
            decoder.feed(b"\x41" * 4096)

    # A hundredth of the stream: a frame, and what the interpreter keeps for itself.
    assert kept_bytes(stream) < 40_960
    assert decoder.feed(b"\x00" + encode_frame(header(3)))[0].header.sequence == 3
    assert decoder.bad_frames == 1
    assert decoder.garbage_bytes == 1000 * 4096
    assert "no delimiter" in decoder.last_error


def test_reserved_overflow_bits_are_ignored():
    body = bytearray(cobs.decode(encode_frame(header())[1:-1])[:HEADER_SIZE])
    body[12:14] = b"\xfa\xff"
    sealed = bytes(body) + zlib.crc32(body).to_bytes(4, "little")
    assert decode_frame(cobs.encode(sealed)).header.overflow is Overflow.BLOCK


@given(U32, st.integers(-(2**31), 2**31 - 1))
def test_the_gap_is_right_over_the_wrap(expected, gap):
    assert sequence_gap(expected, (expected + gap) % 2**32) == gap


def test_the_tracker_counts_lost_and_old_frames():
    tracker = SequenceTracker()
    gaps = [tracker.check(header(n % 2**32)) for n in (2**32 - 2, 2**32 - 1, 2**32, 2**32 + 3)]
    assert gaps == [0, 0, 0, 2]
    assert tracker.check(header(1)) == -3
    assert tracker.check(header(4)) == 0
    assert (tracker.missing, tracker.disordered) == (2, 1)


def test_the_tracker_starts_anew_with_another_session():
    tracker = SequenceTracker()
    tracker.check(header(1000))
    assert tracker.check(Header(type=FrameType.STATUS, session=2, sequence=7)) == 0
    assert tracker.check(Header(type=FrameType.STATUS, session=2, sequence=8)) == 0
    assert tracker.missing == 0
