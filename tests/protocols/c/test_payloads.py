"""Payloads and dictionaries in C against the vectors and against Python, both ways."""

import json
import struct
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.any_record import records
from support.c_device import FFI, VECTORS, C, accepts, configuration_fields, entries

from armodal.protocols.board import (
    MESSAGES,
    BoardDictionary,
    Channel,
    Configuration,
    FrameType,
    IepeState,
    Slope,
    decode_dictionary,
    encode_dictionary,
    refusal,
)
from armodal.protocols.board.generate.table import snake
from armodal.protocols.board.layout import decode, encode, layout_of
from armodal.protocols.errors import FrameError

VECTOR_FOLDER = Path(__file__).resolve().parents[2] / "vectors"
FIELD_VECTORS = json.loads((VECTOR_FOLDER / "board-fields-v1.json").read_text(encoding="utf-8"))
U8, U32 = (st.integers(0, 2**bits - 1) for bits in (8, 32))
DICTIONARY_OF = {entry["name"]: entry["encoded"] for entry in VECTORS["dictionaries"]}
VECTOR_DICTIONARY = DICTIONARY_OF["two channels"]


def struct_of(record):
    """A record as C holds it, and the names of its functions."""
    name = snake(record.__name__)
    return f"ab_{name} *", getattr(C, f"ab_read_{name}"), getattr(C, f"ab_write_{name}")


def read_record(record, data):
    """What C reads: None where it refuses."""
    kind, reader, _ = struct_of(record)
    found = FFI.new(kind)
    return found if reader(data, len(data), found) else None


def write_record(found, record):
    """The bytes that C writes."""
    to = FFI.new("uint8_t[]", layout_of(record).size)
    struct_of(record)[2](to, found)
    return bytes(FFI.buffer(to))


def numbers_of(found, record):
    """The fields of a C record as Python's record holds them."""
    fields = {}
    for field in layout_of(record).fields:
        if field.is_stored:
            numbers = [getattr(found, name) for name, _ in field.numbers]
            fields[field.name] = Fraction(*numbers) if len(numbers) > 1 else numbers[0]
    return fields


RECORDS = sorted({m.record for m in MESSAGES.values() if m.record}, key=lambda r: r.__name__)


@entries("frames")
def test_a_payload_vector_reads_and_writes_the_same_bytes(vector):
    kind, payload = FrameType[vector["type"]], bytes.fromhex(vector["payload"])
    message = MESSAGES[kind]
    # A refused STATUS has no record; the vectors have none of these.
    assert C.ab_payload_valid(kind, payload, len(payload))
    if message.record is None:
        return
    body = payload[2:] if message.is_answer else payload
    head = body[: layout_of(message.record).size]
    found = read_record(message.record, body)
    assert write_record(found, message.record) == head
    known = decode(message.record, head)
    assert numbers_of(found, message.record) == {
        name: getattr(known, name) for name in numbers_of(found, message.record)
    }


@entries("frames")
def test_a_reply_vector_gives_its_code_and_reason(vector):
    if not MESSAGES[FrameType[vector["type"]]].is_answer:
        return
    payload = bytes.fromhex(vector["payload"])
    keep = FFI.new("uint8_t[]", payload)  # into which the reason points
    code, reason, size = FFI.new("uint8_t *"), FFI.new("uint8_t **"), FFI.new("size_t *")
    assert C.ab_read_reply(keep, len(payload), code, reason, size)
    found = bytes(FFI.buffer(reason[0], size[0])).decode()
    assert (code[0], found) == (vector["fields"]["code"], vector["fields"]["reason"])


@entries("invalid_payloads")
def test_an_invalid_payload_is_refused(vector):
    payload = bytes.fromhex(vector["payload"])
    assert not C.ab_payload_valid(FrameType[vector["type"]], payload, len(payload))


def field_vectors(key):
    """Extremes of every field but the header's, which has no reader of its own that refuses."""
    rows = [row for row in FIELD_VECTORS[key] if row["record"] != "header"]
    return pytest.mark.parametrize("vector", rows, ids=lambda row: row["name"])


@field_vectors("records")
def test_c_reads_and_writes_every_extreme_of_a_field(vector):
    record, data = MESSAGES[FrameType[vector["record"]]].record, bytes.fromhex(vector["bytes"])
    found = read_record(record, data)
    assert found is not None
    assert write_record(found, record) == data
    for name, value in vector["fields"].items():
        wanted = Fraction(*value) if isinstance(value, list) else int(value)
        assert numbers_of(found, record)[name] == wanted


@field_vectors("invalid_records")
def test_c_refuses_what_is_outside_a_range(vector):
    record = MESSAGES[FrameType[vector["record"]]].record
    assert read_record(record, bytes.fromhex(vector["bytes"])) is None


@given(st.data())
def test_any_record_passes_between_the_sides(data):
    record = data.draw(st.sampled_from(RECORDS))
    wanted = data.draw(records(record))
    encoded = encode(wanted)
    found = read_record(record, encoded)
    assert found is not None
    assert write_record(found, record) == encoded
    assert decode(record, write_record(found, record)) == wanted


@given(st.data())
def test_both_sides_refuse_the_same_records(data):
    record = data.draw(st.sampled_from(RECORDS))
    size = layout_of(record).size
    mostly_small = st.lists(st.sampled_from([0, 1, 2, 3, 255]), min_size=size, max_size=size)
    damaged = bytes(data.draw(mostly_small))
    try:
        decode(record, damaged)
    except FrameError:
        assert read_record(record, damaged) is None
    else:
        assert read_record(record, damaged) is not None


# Dictionaries


def as_c(dictionary):
    """The struct that a firmware writes down, and what must live as long."""
    keep = []

    def text(value):
        keep.append(FFI.new("char[]", value.encode()))
        return keep[-1]

    texts = ("name", "quantity", "unit", "serial_number", "calibration_date")
    channels = FFI.new("ab_channel[]", len(dictionary.channels))
    for to, channel in zip(channels, dictionary.channels, strict=True):
        for name in texts:
            setattr(to, name, text(getattr(channel, name)))
        for name in ("scale", "full_scale", "highpass_hz", "iepe"):
            setattr(to, name, getattr(channel, name))
        keep.append(FFI.new("uint8_t[]", channel.teds))
        to.teds, to.teds_size = keep[-1], len(channel.teds)
    made = FFI.new("ab_dictionary *")
    made.board_id, made.firmware = text(dictionary.board_id), text(dictionary.firmware)
    for name in ("link_bytes_per_s", "block_capacity", "tick_hz", "filter_group_delay_samples"):
        setattr(made, name, getattr(dictionary, name))
    made.channels, made.n_channels = channels, len(channels)
    return made, [channels, *keep]


def encode_in_c(dictionary, size=65_535):
    made, _keep = as_c(dictionary)
    to = FFI.new("uint8_t[]", size)
    return bytes(FFI.buffer(to, C.ab_dictionary_encode(to, size, made)))


def channels_in_c(encoded):
    """Channels as the C reader finds them."""
    keep, view, found = FFI.new("uint8_t[]", encoded), FFI.new("ab_channel_view *"), []
    while C.ab_dictionary_channel(keep, len(found), view):
        name, quantity, unit, serial, date = (
            bytes(FFI.buffer(text + 1, text[0])).decode() for text in view.texts
        )
        bits = struct.pack("<QQQ", view.scale, view.full_scale, view.highpass_hz)
        scale, full_scale, highpass_hz = struct.unpack("<ddd", bits)
        found.append(
            Channel(
                name=name,
                quantity=quantity,
                unit=unit,
                scale=scale,
                full_scale=full_scale,
                iepe=IepeState(view.iepe),
                highpass_hz=highpass_hz,
                serial_number=serial,
                calibration_date=date,
                teds=bytes(FFI.buffer(view.teds, view.teds_size)),
            )
        )
    return tuple(found)


@entries("dictionaries")
def test_a_dictionary_vector_reads_and_writes_the_same_bytes(vector):
    encoded = bytes.fromhex(vector["encoded"])
    dictionary = decode_dictionary(encoded)
    assert encode_in_c(dictionary, len(encoded)) == encoded
    assert encode_in_c(dictionary, len(encoded) - 1) == b""
    assert accepts(encoded)
    assert channels_in_c(encoded) == dictionary.channels
    assert C.ab_crc32(0, encoded, len(encoded)) & 0xFFFF == vector["hash"]


TEXT = st.text(st.characters(exclude_categories=["Cc", "Cs"]), max_size=20)
DATES = st.one_of(st.just(""), st.dates().map(lambda day: day.isoformat()))
CHANNELS = st.builds(
    Channel,
    name=TEXT.filter(bool),
    quantity=TEXT.filter(bool),
    unit=TEXT.filter(bool),
    scale=st.floats(allow_nan=False, allow_infinity=False).filter(bool),
    full_scale=st.floats(min_value=0, exclude_min=True, allow_infinity=False),
    iepe=st.sampled_from(IepeState),
    highpass_hz=st.floats(min_value=0, allow_infinity=False),
    serial_number=TEXT,
    calibration_date=DATES,
    teds=st.binary(max_size=20),
)
DICTIONARIES = st.builds(
    BoardDictionary,
    board_id=TEXT,
    firmware=TEXT,
    link_bytes_per_s=st.integers(1, 2**32 - 1),
    block_capacity=st.integers(1, 2**32 - 1),
    tick_hz=st.integers(1, 2**32 - 1),
    filter_group_delay_samples=st.floats(min_value=0, allow_infinity=False),
    channels=st.lists(CHANNELS, min_size=1, max_size=4, unique_by=lambda c: c.name).map(tuple),
)


@given(DICTIONARIES)
def test_a_dictionary_passes_between_the_sides(dictionary):
    encoded = encode_in_c(dictionary)
    assert encoded == encode_dictionary(dictionary)
    assert channels_in_c(encode_dictionary(dictionary)) == dictionary.channels


@given(DICTIONARIES, st.data())
def test_both_sides_refuse_the_same_dictionaries(dictionary, data):
    encoded = bytearray(encode_dictionary(dictionary))
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(encoded) - 1))
        encoded[at] = data.draw(st.sampled_from([0, 1, 0x7F, 0x80, 0xF0, 0xFF]) | U8)
    damaged = bytes(encoded[: data.draw(st.integers(0, len(encoded)))] + bytes(data.draw(U8) % 2))
    for each in (bytes(encoded), damaged):
        try:
            decode_dictionary(each)
        except FrameError:
            assert not accepts(each)
        else:
            assert accepts(each)


@pytest.mark.parametrize(
    "changes",
    [
        {"calibration_date": "2023-02-29"},
        {"calibration_date": "2024-04-31"},
        {"calibration_date": "2024-13-01"},
        {"calibration_date": "2024-01-1"},
        {"scale": 0.0},
        {"scale": float("nan")},
        {"full_scale": -1.0},
        {"highpass_hz": float("inf")},
        {"name": ""},
        {"unit": "x" * 256},
    ],
)
def test_a_channel_that_breaks_a_rule_gives_no_dictionary(changes):
    good = decode_dictionary(bytes.fromhex(VECTOR_DICTIONARY))
    broken = replace(good, channels=(replace(good.channels[0], **changes), *good.channels[1:]))
    assert encode_in_c(good)
    assert encode_in_c(broken) == b""


def test_two_channels_of_one_name_give_no_dictionary():
    good = decode_dictionary(bytes.fromhex(VECTOR_DICTIONARY))
    assert encode_in_c(replace(good, channels=(good.channels[0], good.channels[0]))) == b""


# Limits


def limits_in_c(configuration, dictionary):
    head = FFI.new("ab_dictionary_head *")
    encoded = encode_dictionary(dictionary)
    assert C.ab_dictionary_check(encoded, len(encoded), head)
    reason = FFI.new("char[]", C.AB_REASON_BYTES)
    code = C.ab_limits(configuration_fields(configuration), head, reason)
    assert bool(FFI.string(reason)) == (code != 0)
    return code


@entries("limits")
def test_a_limit_vector_is_refused_or_not(vector):
    fields = dict(vector["configuration"])
    fields |= {"rate_hz": Fraction(*fields["rate_hz"]), "slope": Slope(fields["slope"])}
    dictionary = decode_dictionary(bytes.fromhex(DICTIONARY_OF[vector["dictionary"]]))
    assert limits_in_c(Configuration(**fields), dictionary) == vector["code"]


PLAUSIBLE = st.builds(
    Configuration,
    rate_hz=st.builds(Fraction, st.integers(1, 2**32 - 1), st.integers(1, 2**32 - 1)),
    channel_mask=st.integers(0, 31),
    trigger_channel=st.integers(0, 5),
    trigger_level_counts=st.integers(-(2**23), 2**23),
    slope=st.sampled_from(Slope),
    pretrigger=st.integers(0, 50),
    block_length=st.integers(0, 2**20) | U32,
    stream=st.booleans(),
)


@given(DICTIONARIES, PLAUSIBLE, st.data())
def test_both_sides_refuse_the_same_configurations(dictionary, configuration, data):
    wanted = data.draw(st.sampled_from([configuration, replace(configuration, channel_mask=1)]))
    assert limits_in_c(wanted, dictionary) == (refusal(wanted, dictionary) or (0, ""))[0]


@given(st.integers(1, 2**32 - 1), st.integers(1, 2**32 - 1), st.integers(-1, 1))
def test_the_link_limit_is_exact(numerator, denominator, beside):
    # One channel: 64 samples in 235 bytes on the wire.
    link = -(-numerator * 235 // (denominator * 64)) + beside
    good = decode_dictionary(bytes.fromhex(VECTOR_DICTIONARY))
    if not 1 <= link < 2**32:
        return
    configuration = Configuration(
        rate_hz=Fraction(numerator, denominator),
        channel_mask=1,
        trigger_channel=0,
        trigger_level_counts=0,
        slope=Slope.RISING,
        pretrigger=0,
        block_length=1,
        stream=True,
    )
    board = replace(good, link_bytes_per_s=link)
    assert limits_in_c(configuration, board) == (refusal(configuration, board) or (0, ""))[0]
