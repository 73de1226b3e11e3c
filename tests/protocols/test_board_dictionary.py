"""The channel dictionary and its journey in fragments."""

import math
import zlib
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.board import (
    BoardDictionary,
    Channel,
    IepeState,
    decode_dictionary,
    dictionary_hash,
    encode_dictionary,
    hello_fragments,
    join_hello,
)
from armodal.protocols.errors import FrameError

PLAIN = st.characters(exclude_categories=["Cc", "Cs"])
TEXT = st.text(PLAIN, max_size=20)
NAMES = st.text(PLAIN, min_size=1, max_size=20)
POSITIVE_U32 = st.integers(1, 2**32 - 1)
POSITIVE = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
NOT_NEGATIVE = st.floats(min_value=0, allow_infinity=False)
CHANNELS = st.builds(
    Channel,
    name=NAMES,
    quantity=NAMES,
    unit=NAMES,
    scale=POSITIVE | POSITIVE.map(lambda scale: -scale),
    full_scale=POSITIVE,
    iepe=st.sampled_from(IepeState),
    highpass_hz=NOT_NEGATIVE,
    serial_number=TEXT,
    calibration_date=st.just("") | st.dates().map(str),
    teds=st.binary(max_size=300),
)
DICTIONARIES = st.builds(
    BoardDictionary,
    board_id=TEXT,
    firmware=TEXT,
    link_bytes_per_s=POSITIVE_U32,
    block_capacity=POSITIVE_U32,
    tick_hz=POSITIVE_U32,
    filter_group_delay_samples=NOT_NEGATIVE,
    channels=st.lists(CHANNELS, min_size=1, max_size=4, unique_by=lambda c: c.name).map(tuple),
)
CHANNEL = Channel(
    name="hammer",
    quantity="force",
    unit="N",
    scale=0.001,
    full_scale=4000.0,
    iepe=IepeState.OK,
    highpass_hz=0.5,
    serial_number="1",
    calibration_date="2025-01-31",
    teds=b"\x01\x02",
)
DICTIONARY = BoardDictionary(
    board_id="board",
    firmware="1",
    link_bytes_per_s=1,
    block_capacity=1,
    tick_hz=1,
    filter_group_delay_samples=0.0,
    channels=(CHANNEL,),
)


@given(DICTIONARIES)
def test_a_dictionary_survives(dictionary):
    assert decode_dictionary(encode_dictionary(dictionary)) == dictionary


@given(DICTIONARIES, st.data())
def test_a_damaged_dictionary_decodes_or_raises_frame_error(dictionary, data):
    encoded = bytearray(encode_dictionary(dictionary))
    for _ in range(data.draw(st.integers(1, 4))):
        encoded[data.draw(st.integers(0, len(encoded) - 1))] = data.draw(st.integers(0, 255))
    damaged = bytes(encoded[: data.draw(st.integers(0, len(encoded)))])
    try:
        found = decode_dictionary(damaged)
    except FrameError:
        return
    assert encode_dictionary(found) == damaged


@given(st.binary(max_size=100))
def test_any_bytes_decode_or_raise_frame_error(data):
    try:
        found = decode_dictionary(data)
    except FrameError:
        return
    assert encode_dictionary(found) == data


@given(st.characters(categories=["Cc"]), st.sampled_from([b"board", b"hammer", b"force"]))
def test_a_control_character_from_a_board_is_refused_and_not_repeated(character, text):
    encoded = encode_dictionary(DICTIONARY)
    other = (character * 5).encode()[:4].ljust(len(text), b"x")
    with pytest.raises(FrameError, match="without control characters") as refused:
        decode_dictionary(encoded.replace(text, other))
    assert str(refused.value).isprintable()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scale": 0.0}, "scale"),
        ({"scale": math.nan}, "scale"),
        ({"full_scale": -1.0}, "full scale"),
        ({"highpass_hz": math.inf}, "high-pass"),
        ({"calibration_date": "31.1.2025"}, "YYYY-MM-DD"),
        ({"calibration_date": "20250131"}, "YYYY-MM-DD"),
        ({"unit": ""}, "unit"),
        ({"name": ""}, "names"),
        ({"serial_number": "x" * 256}, "255 bytes"),
        ({"name": "\ud800"}, "UTF-8"),
        ({"name": "ham\0mer"}, "channel 0: name: text without control characters"),
        ({"unit": "N\n"}, "unit: text without control"),
        ({"quantity": "force\x7f"}, "quantity: text without control"),
        ({"serial_number": "\x1b[2J"}, "serial number: text without control"),
        ({"calibration_date": "\x9f"}, "calibration date: text without control"),
        ({"teds": bytes(70_000)}, "TEDS"),
    ],
)
def test_an_impossible_channel_is_refused(change, message):
    with pytest.raises(FrameError, match=message):
        encode_dictionary(replace(DICTIONARY, channels=(replace(CHANNEL, **change),)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"channels": ()}, "channels"),
        ({"channels": (CHANNEL, CHANNEL)}, "differ"),
        ({"tick_hz": 0}, "tick_hz"),
        ({"link_bytes_per_s": 2**32}, "does not fit"),
        ({"filter_group_delay_samples": -1.0}, "group delay"),
        ({"board_id": "a\0"}, "board id: text without control"),
        ({"firmware": "1\r"}, "firmware version: text without control"),
    ],
)
def test_an_impossible_board_is_refused(change, message):
    with pytest.raises(FrameError, match=message):
        encode_dictionary(replace(DICTIONARY, **change))


def test_a_dictionary_longer_than_its_length_field_is_refused():
    channels = tuple(replace(CHANNEL, name=str(i), teds=bytes(30_000)) for i in range(3))
    with pytest.raises(FrameError, match="65535"):
        encode_dictionary(replace(DICTIONARY, channels=channels))


def test_the_hash_is_the_low_half_of_the_crc():
    assert dictionary_hash(b"123456789") == 0xCBF43926 & 0xFFFF == zlib.crc32(b"123456789") % 2**16


@given(st.binary(min_size=1, max_size=3000), st.randoms(use_true_random=False))
def test_fragments_join_in_any_order_and_with_repetitions(encoded, random):
    fragments = hello_fragments(encoded)
    shuffled = fragments * 2
    random.shuffle(shuffled)
    assert join_hello(shuffled) == encoded


@given(st.binary(min_size=600, max_size=3000), st.data())
def test_a_missing_fragment_is_waited_for(encoded, data):
    fragments = hello_fragments(encoded)
    fragments.pop(data.draw(st.integers(0, len(fragments) - 1)))
    assert join_hello(fragments) is None


def test_no_fragments_are_waited_for():
    assert join_hello([]) is None


@pytest.mark.parametrize(
    ("fragments", "message"),
    [
        ([b"\x04\0\0\0ab", b"\x05\0\0\0ab"], "disagree"),
        ([b"\x04\0\0\0ab", b"\x04\0\0\0ac"], "disagree"),
        ([b"\x04\0\0\0ab", b"\x04\0\1\0ab"], "overlap"),
        ([b"\x04\0\0\0abcde"], "do not lie"),
        ([b"\0\0\0\0"], "total 1 or more"),
        ([b"\x04\0\0\0"], "do not lie"),
        ([b"\x04\0\0"], "bytes wanted"),
    ],
)
def test_fragments_that_do_not_fit_together_are_refused(fragments, message):
    with pytest.raises(FrameError, match=message):
        join_hello(fragments)


@given(st.lists(st.binary(max_size=12), max_size=6))
def test_any_fragments_join_wait_or_raise_frame_error(payloads):
    try:
        joined = join_hello(payloads)
    except FrameError:
        return
    assert joined is None or len(joined) <= 0xFFFF
