"""The C codec against the shared vectors and against the Python codec, both ways."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from support.c_device import FFI, VECTORS, C, entries

from armodal.protocols.board import (
    Frame,
    FrameDecoder,
    FrameType,
    Header,
    Overflow,
    decode_frame,
    encode_frame,
    wire_size,
)

RESULTS = {"ok": 0, "cobs": 1, "short": 2, "long": 3, "crc": 4, "version": 5, "type": 6}
FIELDS = ("dictionary_hash", "session", "sequence", "overflow", "tag", "first_sample", "ticks")

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
# Long stretches without a zero are where COBS begins another piece.
PAYLOADS = st.one_of(
    st.binary(max_size=400),
    st.integers(0, 2048).map(lambda n: b"\xff" * n),
    st.tuples(st.integers(0, 600), st.binary(max_size=5)).map(lambda p: b"\x01" * p[0] + p[1]),
)


def encode_in_c(header, payload, *, size=None, portions=()):
    wire = FFI.new("uint8_t[]", size or wire_size(len(payload)))
    values = {name: int(getattr(header, name)) for name in FIELDS}
    given_header = FFI.new("ab_header *", {"version": 1, "type": header.type, **values})
    encoder = FFI.new("ab_encoder *")
    C.ab_encoder_begin(encoder, wire, len(wire), given_header)
    at = 0
    for portion in [*portions, len(payload)]:
        piece = payload[at : at + portion]
        C.ab_encoder_add(encoder, piece, len(piece))
        at += len(piece)
    return bytes(FFI.buffer(wire, C.ab_encoder_end(encoder)))


def decode_in_c(encoded):
    """The result, and the frame where there is one."""
    buffer = FFI.new("uint8_t[]", encoded)
    header, payload, n = FFI.new("ab_header *"), FFI.new("uint8_t **"), FFI.new("size_t *")
    result = C.ab_frame_decode(buffer, len(encoded), header, payload, n)
    if result != RESULTS["ok"]:
        return result, None
    values = {name: getattr(header, name) for name in FIELDS}
    values["overflow"] = Overflow(values["overflow"])
    found = Header(type=FrameType(header.type), **values)
    return result, Frame(header=found, payload=bytes(FFI.buffer(payload[0], n[0])))


@given(st.binary(max_size=100), st.binary(max_size=100))
def test_the_crc_goes_on_where_it_ended(first, second):
    whole = C.ab_crc32(0, first + second, len(first + second))
    assert C.ab_crc32(C.ab_crc32(0, first, len(first)), second, len(second)) == whole


def test_the_crc_is_the_one_of_the_document():
    assert C.ab_crc32(0, b"123456789", 9) == 0xCBF43926


@entries("frames")
def test_a_frame_vector_decodes_and_encodes_to_the_same_bytes(vector):
    wire = bytes.fromhex(vector["wire"])
    result, frame = decode_in_c(wire[1:-1])
    assert result == RESULTS["ok"]
    assert frame.header.type.name == vector["type"]
    for name in FIELDS:
        assert getattr(frame.header, name) == int(vector["header"][name])
    assert frame.payload.hex() == vector["payload"]
    assert encode_in_c(frame.header, frame.payload) == wire


@entries("invalid_frames")
def test_an_invalid_frame_is_refused_for_its_reason(vector):
    assert decode_in_c(bytes.fromhex(vector["encoded"]))[0] == RESULTS[vector["reason"]]


def receive_in_c(data, portions):
    receiver = FFI.new("ab_receiver *")
    buffer = FFI.new("uint8_t[]", C.AB_MAX_ENCODED)
    receiver.buffer, receiver.size = buffer, len(buffer)
    header, payload, n = FFI.new("ab_header *"), FFI.new("uint8_t **"), FFI.new("size_t *")
    stretch, sequences, at = FFI.new("size_t *"), [], 0
    for portion in portions:
        piece = data[at : at + portion]
        at += len(piece)
        while piece:
            piece = piece[C.ab_receiver_take(receiver, piece, len(piece), stretch) :]
            if stretch[0] and C.ab_receiver_decode(receiver, stretch[0], header, payload, n) == 0:
                sequences.append(header.sequence)
    return sequences, receiver.bad_frames, receiver.garbage_bytes


@entries("streams")
def test_a_stream_vector_gives_its_frames_in_any_portions(vector):
    data = bytes.fromhex(vector["bytes"])
    expected = (vector["sequences"], vector["bad_frames"], vector["garbage_bytes"])
    for portion in (1, 7, len(data)):
        assert receive_in_c(data, [portion] * len(data)) == expected


@given(
    st.lists(
        st.one_of(
            st.binary(max_size=60),
            st.builds(encode_frame, HEADERS, st.binary(max_size=60)),
            st.integers(2000, 2200).map(lambda n: b"\x05" * n),
        ),
        max_size=6,
    ),
    st.lists(st.integers(1, 500), max_size=20),
)
def test_both_receivers_make_the_same_of_any_bytes(parts, portions):
    data = b"".join(parts) + b"\x00"
    python = FrameDecoder()
    sequences = [frame.header.sequence for frame in python.feed(data)]
    found = receive_in_c(data, [*portions, len(data)])
    assert found == (sequences, python.bad_frames, python.garbage_bytes)


@given(HEADERS, PAYLOADS, st.lists(st.integers(0, 300), max_size=5))
def test_each_side_reads_what_the_other_wrote(header, payload, portions):
    wire = encode_in_c(header, payload, portions=portions)
    assert wire == encode_frame(header, payload)
    assert decode_frame(wire[1:-1]) == Frame(header=header, payload=payload)
    assert decode_in_c(encode_frame(header, payload)[1:-1]) == (
        RESULTS["ok"],
        Frame(header=header, payload=payload),
    )


@given(HEADERS, PAYLOADS)
def test_a_buffer_one_byte_too_small_gives_no_frame(header, payload):
    wire = encode_in_c(header, payload)
    assert encode_in_c(header, payload, size=len(wire) - 1) == b""


@entries("sequences")
def test_a_sequence_vector_gives_its_gap(vector):
    assert C.ab_sequence_gap(vector["expected"], vector["sequence"]) == vector["gap"]


@entries("samples")
def test_a_samples_vector_packs(vector):
    encoded = bytes.fromhex(vector["encoded"])
    to = FFI.new("uint8_t[]", len(encoded))
    at = to
    for count in np.ravel(vector["counts"]):
        at = C.ab_write_count(at, int(count))
    assert bytes(FFI.buffer(to)) == encoded


def test_counts_beyond_24_bits_become_the_extreme_ones():
    to = FFI.new("uint8_t[3]")
    for count, expected in ((2**31 - 1, "ffff7f"), (-(2**31), "000080"), (2**23, "ffff7f")):
        C.ab_write_count(to, count)
        assert bytes(FFI.buffer(to)).hex() == expected


def test_every_key_of_the_vectors_is_tested_here_or_with_the_payloads():
    lists = {key for key, value in VECTORS.items() if isinstance(value, list)}
    here = {"frames", "invalid_frames", "streams", "samples", "sequences"}
    assert lists == here | {"invalid_payloads", "dictionaries", "limits"}
