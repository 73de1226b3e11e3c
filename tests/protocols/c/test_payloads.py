"""Payloads and dictionaries in C against the vectors and against Python, both ways."""

import struct
from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.c_device import FFI, VECTORS, C, accepts, configuration_fields, entries

from armodal.protocols.board import (
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Channel,
    Configuration,
    FrameType,
    IepeState,
    Slope,
    decode_configuration,
    decode_dictionary,
    encode_block_info,
    encode_configuration,
    encode_dictionary,
    encode_release,
    encode_resend,
    encode_status,
    refusal,
)
from armodal.protocols.errors import FrameError

U8, U32, U64 = (st.integers(0, 2**bits - 1) for bits in (8, 32, 64))
DICTIONARY_OF = {entry["name"]: entry["encoded"] for entry in VECTORS["dictionaries"]}
VECTOR_DICTIONARY = DICTIONARY_OF["two channels"]


READERS = {
    "CONFIGURE": (C.ab_read_configuration, "ab_configuration *"),
    "STATUS_REPLY": (C.ab_read_status, "ab_status *"),
    "BLOCK_READY": (C.ab_read_block_info, "ab_block_info *"),
    "RESEND": (C.ab_read_range, "ab_range *"),
    "RELEASE": (C.ab_read_block_id, "uint32_t *"),
    "HELLO_REPLY": (C.ab_read_fragment, "uint16_t *", "uint16_t *"),
    "STREAM": (partial(C.ab_read_data, FrameType.STREAM), "ab_data *"),
    "BLOCK_DATA": (partial(C.ab_read_data, FrameType.BLOCK_DATA), "ab_data *"),
}
REPLY = (C.ab_read_reply, "uint8_t *", "uint8_t **", "size_t *")


def read(kind, payload):
    """What the C reader of a type makes of a payload: None where it refuses."""
    function, *types = READERS.get(kind, REPLY)
    results = [FFI.new(each) for each in types]
    # The reason of a reply points into the payload, which must live as long.
    keep = FFI.new("uint8_t[]", payload)
    if not function(keep, len(payload), *results):
        return None
    if kind not in READERS:
        code, reason, size = results
        return code[0], bytes(FFI.buffer(reason[0], size[0])).decode()
    return results[0] if len(results) == 1 else results


def write(kind, value):
    """The C writer's payload of what `read` gave."""
    if kind in ("STREAM", "BLOCK_DATA"):
        to = FFI.new("uint8_t[8]")
        n = C.ab_write_data_prefix(to, value.n_samples, value.n_channels, value.block_id)
        return bytes(FFI.buffer(to, n))
    size, function = {
        "CONFIGURE": (28, C.ab_write_configuration),
        "STATUS_REPLY": (39, C.ab_write_status),
        "BLOCK_READY": (32, C.ab_write_block_info),
        "RESEND": (12, C.ab_write_range),
    }[kind]
    to = FFI.new("uint8_t[]", size)
    function(to, value)
    return bytes(FFI.buffer(to))


@entries("frames")
def test_a_payload_vector_reads_and_writes_the_same_bytes(vector):
    kind, payload, fields = vector["type"], bytes.fromhex(vector["payload"]), vector["fields"]
    if not payload:
        return
    found = read(kind, payload)
    assert found is not None
    if kind in ("STREAM", "BLOCK_DATA"):
        prefix = write(kind, found)
        assert payload.startswith(prefix)
        assert found.n_samples == len(fields["counts"])
    elif kind == "RELEASE":
        assert found[0] == fields["block_id"]
    elif kind == "HELLO_REPLY":
        assert (found[0][0], found[1][0]) == (fields["total"], fields["offset"])
    elif kind.endswith("_REPLY") and kind != "STATUS_REPLY":
        assert found == (fields["code"], fields["reason"])
    else:
        assert write(kind, found) == payload
        shared = {"state", "next_sample", "first_sample", "trigger_ticks", "pretrigger", "count"}
        for name in shared & fields.keys():
            assert getattr(found, name) == int(fields[name])


@entries("invalid_payloads")
def test_an_invalid_payload_is_refused(vector):
    assert read(vector["type"], bytes.fromhex(vector["payload"])) is None


CONFIGURATIONS = st.builds(
    Configuration,
    rate_hz=st.builds(Fraction, st.integers(1, 2**32 - 1), st.integers(1, 2**32 - 1)),
    channel_mask=U32,
    trigger_channel=U8,
    trigger_level_counts=st.integers(-(2**31), 2**31 - 1),
    slope=st.sampled_from(Slope),
    pretrigger=U32,
    block_length=U32,
    stream=st.booleans(),
)


@given(CONFIGURATIONS)
def test_a_configuration_passes_between_the_sides(configuration):
    encoded = encode_configuration(configuration)
    assert write("CONFIGURE", read("CONFIGURE", encoded)) == encoded
    assert decode_configuration(write("CONFIGURE", configuration_fields(configuration))) == (
        configuration
    )


@given(
    st.builds(
        BoardStatus,
        state=st.sampled_from(BoardState),
        next_sequence=U32,
        next_sample=U64,
        buffered_blocks=U32,
        oldest_block=U32,
        stream_samples_dropped=U64,
        triggers_missed=U32,
        adc_overruns=U32,
    )
)
def test_a_status_passes_between_the_sides(status):
    encoded = encode_status(status)
    found = read("STATUS_REPLY", encoded)
    assert found.stream_samples_dropped == status.stream_samples_dropped
    assert write("STATUS_REPLY", found) == encoded


@given(st.integers(1, 2**32 - 1), st.integers(1, 2**32 - 1), st.integers(0, 2**63), U64, st.data())
def test_a_block_announcement_passes_between_the_sides(block, length, first, ticks, data):
    info = BlockInfo(
        block_id=block,
        first_sample=first,
        length=length,
        trigger_sample=first + data.draw(st.integers(0, length - 1)),
        trigger_ticks=ticks,
    )
    encoded = encode_block_info(info)
    assert write("BLOCK_READY", read("BLOCK_READY", encoded)) == encoded


@given(U32, U32, U32)
def test_resend_and_release_pass_between_the_sides(block, first, count):
    encoded = encode_resend(block, first, count)
    assert write("RESEND", read("RESEND", encoded)) == encoded
    to = FFI.new("uint8_t[4]")
    C.ab_write_block_id(to, block)
    assert bytes(FFI.buffer(to)) == encode_release(block)


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
