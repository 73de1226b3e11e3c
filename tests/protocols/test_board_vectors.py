"""The vector file and the document are what the code makes, and read back by another way."""

import json
import struct
import subprocess
import sys
import zlib
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from armodal.protocols.board import (
    MESSAGES,
    Configuration,
    Frame,
    FrameDecoder,
    FrameType,
    Header,
    Overflow,
    Slope,
    decode_answer,
    decode_dictionary,
    decode_frame,
    decode_payload,
    decode_reply,
    decode_samples,
    dictionary_hash,
    encode_dictionary,
    encode_frame,
    join_hello,
    pack_counts,
    refusal,
    sequence_gap,
    unpack_counts,
)
from armodal.protocols.errors import FrameError

ROOT = Path(__file__).resolve().parents[2]
MAKER = ROOT / "tests" / "vectors" / "make_board_vectors.py"
VECTORS = json.loads((ROOT / "tests" / "vectors" / "board-v1.json").read_text(encoding="utf-8"))

SAYS = {
    "cobs": "not COBS",
    "short": "at least 36 bytes",
    "long": "at most",
    "crc": "CRC-32",
    "version": "version 2",
    "type": "frame type",
}


def entries(key):
    return pytest.mark.parametrize("vector", VECTORS[key], ids=lambda vector: vector.get("name"))


def cobs_decode_as_the_document_says(encoded: bytes) -> bytes:
    out, at = bytearray(), 0
    while at < len(encoded):
        code = encoded[at]
        out += encoded[at + 1 : at + code]
        at += code
        if code != 255 and at < len(encoded):
            out.append(0)
    return bytes(out)


def cobs_encode_as_the_document_says(body: bytes) -> bytes:
    out, code_at, code = bytearray(1), 0, 1
    for i, byte in enumerate(body):
        last = i == len(body) - 1
        if byte:
            out.append(byte)
            code += 1
        if not byte or (code == 255 and not last):
            out[code_at] = code
            code_at, code = len(out), 1
            out.append(0)
    out[code_at] = code
    return bytes(out)


def header_of(vector) -> Header:
    values = {name: int(value) for name, value in vector["header"].items()}
    values["overflow"] = Overflow(values["overflow"])
    return Header(type=FrameType[vector["type"]], **values)


def read_payload(frame: Frame) -> object:
    kind, payload = frame.header.type, frame.payload
    message = MESSAGES[kind]
    if kind is FrameType.HELLO_REPLY:
        return join_hello([payload])
    if kind in (FrameType.STREAM, FrameType.BLOCK_DATA):
        return decode_samples(frame)
    if message.record is None:
        return decode_reply(payload)
    return (decode_answer if message.is_answer else decode_payload)(message.record, payload)


def test_vectors_and_worked_example_are_what_the_code_makes():
    done = subprocess.run(
        [sys.executable, str(MAKER), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_frame_type_has_a_vector():
    assert {vector["type"] for vector in VECTORS["frames"]} == set(FrameType.__members__)


@entries("frames")
def test_a_frame_vector_decodes_by_the_document_alone(vector):
    wire = bytes.fromhex(vector["wire"])
    body = cobs_decode_as_the_document_says(wire[1:-1])
    assert b"\0" + cobs_encode_as_the_document_says(body) + b"\0" == wire
    (crc,) = struct.unpack("<I", body[-4:])
    assert crc == zlib.crc32(body[:-4])
    assert body[32:-4].hex() == vector["payload"]
    header = {name: int(value) for name, value in vector["header"].items()}
    names = ("dictionary_hash", "session", "sequence", "overflow", "tag", "first_sample", "ticks")
    assert struct.unpack("<BBHIIHHQQ", body[:32]) == (
        1,
        FrameType[vector["type"]],
        *(header[name] for name in names),
    )


@entries("frames")
def test_a_frame_vector_round_trips_through_the_codec(vector):
    wire = bytes.fromhex(vector["wire"])
    (frame,) = FrameDecoder().feed(wire)
    assert frame == Frame(header=header_of(vector), payload=bytes.fromhex(vector["payload"]))
    assert encode_frame(frame.header, frame.payload) == wire
    if frame.payload:
        read_payload(frame)


@entries("invalid_frames")
def test_an_invalid_frame_is_refused_for_its_reason(vector):
    with pytest.raises(FrameError, match=SAYS[vector["reason"]]):
        decode_frame(bytes.fromhex(vector["encoded"]))


@entries("invalid_payloads")
def test_an_invalid_payload_is_refused(vector):
    header = Header(type=FrameType[vector["type"]], session=1, sequence=0)
    with pytest.raises(FrameError):
        read_payload(Frame(header=header, payload=bytes.fromhex(vector["payload"])))


@entries("streams")
@pytest.mark.parametrize("portion", [1, 7, 100_000])
def test_a_stream_vector_gives_its_frames_in_any_portions(vector, portion):
    data = bytes.fromhex(vector["bytes"])
    decoder = FrameDecoder()
    found = [
        frame.header.sequence
        for start in range(0, len(data), portion)
        for frame in decoder.feed(data[start : start + portion])
    ]
    assert found == vector["sequences"]
    assert (decoder.bad_frames, decoder.garbage_bytes) == (
        vector["bad_frames"],
        vector["garbage_bytes"],
    )


@entries("dictionaries")
def test_a_dictionary_vector_reads_and_joins(vector):
    encoded = bytes.fromhex(vector["encoded"])
    dictionary = decode_dictionary(encoded)
    assert encode_dictionary(dictionary) == encoded
    assert dictionary_hash(encoded) == vector["hash"]
    assert join_hello([bytes.fromhex(part) for part in vector["fragments"]]) == encoded
    assert [c.name for c in dictionary.channels] == [
        c["name"] for c in vector["fields"]["channels"]
    ]
    assert [c.scale for c in dictionary.channels] == [
        c["scale"] for c in vector["fields"]["channels"]
    ]


@entries("samples")
def test_a_samples_vector_packs_and_unpacks(vector):
    counts = np.array(vector["counts"], dtype=np.int32)
    assert pack_counts(counts).hex() == vector["encoded"]
    found = unpack_counts(bytes.fromhex(vector["encoded"]), counts.shape[1])
    np.testing.assert_array_equal(found, counts)


@entries("sequences")
def test_a_sequence_vector_gives_its_gap(vector):
    assert sequence_gap(vector["expected"], vector["sequence"]) == vector["gap"]


@entries("limits")
def test_a_limit_vector_is_refused_or_not(vector):
    boards = {d["name"]: bytes.fromhex(d["encoded"]) for d in VECTORS["dictionaries"]}
    fields = dict(vector["configuration"])
    fields["rate_hz"] = Fraction(*fields["rate_hz"])
    fields["slope"] = Slope(fields["slope"])
    refused = refusal(Configuration(**fields), decode_dictionary(boards[vector["dictionary"]]))
    assert (refused or (0, ""))[0] == vector["code"]
