from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.kept_memory import kept_bytes

from armodal.protocols.errors import CanError
from armodal.protocols.slcan import (
    MAX_LINE,
    CanFrame,
    SlcanFault,
    SlcanParser,
    SlcanReply,
    bitrate_command,
    encode_slcan,
    listen_only_commands,
)

frames = st.builds(
    lambda extended, number, data: CanFrame(
        can_id=number & (0x1FFFFFFF if extended else 0x7FF), extended=extended, data=data
    ),
    st.booleans(),
    st.integers(0, 0x1FFFFFFF),
    st.binary(max_size=8),
)


def line_of(frame: CanFrame) -> bytes:
    return encode_slcan(frame.can_id, frame.data, extended=frame.extended)


def in_chunks(data: bytes, cuts: list[int]) -> list[bytes]:
    edges = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [data[a:b] for a, b in pairwise(edges)]


@given(st.lists(frames, max_size=8), st.lists(st.integers(0, 400), max_size=12))
def test_frames_round_trip_however_the_bytes_are_cut(sent: list[CanFrame], cuts: list[int]) -> None:
    parser = SlcanParser()
    got = []
    for chunk in in_chunks(b"".join(line_of(f) for f in sent), cuts):
        got += parser.feed(chunk)
    assert got == sent
    assert (parser.frames, parser.faults) == (len(sent), 0)


@given(st.binary(max_size=400), st.lists(st.integers(0, 400), max_size=6))
def test_any_bytes_are_tolerated_and_cut_points_do_not_matter(data: bytes, cuts: list[int]) -> None:
    whole, cut = SlcanParser(), SlcanParser()
    expected = whole.feed(data)
    got = []
    for chunk in in_chunks(data, cuts):
        got += cut.feed(chunk)
    assert got == expected
    assert sum(isinstance(item, SlcanFault) for item in got) == cut.faults
    for item in got:
        if isinstance(item, SlcanFault):
            assert len(item.line) <= MAX_LINE


@given(st.binary(max_size=200), frames)
def test_no_garbage_poisons_the_line_after_it(garbage: bytes, frame: CanFrame) -> None:
    parser = SlcanParser()
    parser.feed(garbage + b"\r")
    assert parser.feed(line_of(frame)) == [frame]


def test_a_byte_above_ascii_spoils_its_own_line_only() -> None:
    parser = SlcanParser()
    good = CanFrame(can_id=0x301, extended=False, data=b"\x01")
    got = parser.feed(b"t3011\x9001\r" + b"t301101\r")
    assert got == [SlcanFault(reason="not-ascii", line=b"t3011\x9001"), good]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (b"t301201", "length"),  # two bytes promised, one there
        (b"t30110102", "length"),  # one promised, two there
        (b"t3019" + b"00" * 9, "length"),  # no classic frame has nine
        (b"t301A" + b"00" * 10, "length"),
        (b"t3011011234", "length"),  # a timestamp nobody asked for
        (b"t8011AA", "identifier"),
        (b"T200000001AA", "identifier"),
        (b"t30", "truncated"),
        (b"t301", "truncated"),
        (b"t", "truncated"),
        (b"t30110_", "not-hex"),  # int() would take underscores and signs
        (b"t+301", "not-hex"),
        (b"t3011 1", "not-hex"),
        (b"d3011AA", "unknown"),  # CAN FD
        (b"hello", "unknown"),
        (b"t3018" + b"00" * 20, "too-long"),
    ],
)
def test_each_kind_of_bad_line_is_named(line: bytes, reason: str) -> None:
    (fault,) = SlcanParser().feed(line + b"\r")
    assert isinstance(fault, SlcanFault)
    assert fault.reason == reason
    assert line.startswith(fault.line)


def test_replies_are_told_apart() -> None:
    got = SlcanParser().feed(b"\r\x07V1013\rF00\rz\rNA123\r")
    assert got == [
        SlcanReply(ok=True, text=""),
        SlcanReply(ok=False, text=""),
        SlcanReply(ok=True, text="V1013"),
        SlcanReply(ok=True, text="F00"),
        SlcanReply(ok=True, text="z"),
        SlcanReply(ok=True, text="NA123"),
    ]


def test_a_refusal_inside_a_line_is_both_fault_and_refusal() -> None:
    got = SlcanParser().feed(b"t3012\x07t301101\r")
    assert got == [
        SlcanFault(reason="truncated", line=b"t3012"),
        SlcanReply(ok=False, text=""),
        CanFrame(can_id=0x301, extended=False, data=b"\x01"),
    ]


def test_line_feeds_after_carriage_returns_are_passed_over() -> None:
    got = SlcanParser().feed(b"\r\nt301101\r\n")
    assert got == [SlcanReply(ok=True, text=""), CanFrame(can_id=0x301, extended=False, data=b"\1")]


def test_remote_frames_carry_no_data() -> None:
    got = SlcanParser().feed(b"r3018\rR000003010\r")
    assert got == [
        CanFrame(can_id=0x301, extended=False, data=b"", remote=True),
        CanFrame(can_id=0x301, extended=True, data=b"", remote=True),
    ]


def test_a_timestamp_that_nobody_switched_on_is_a_fault_of_length() -> None:
    (fault,) = SlcanParser().feed(b"t3011011A2B\r")
    assert isinstance(fault, SlcanFault)
    assert fault.reason == "length"


def test_memory_stays_bounded_without_a_separator() -> None:
    parser = SlcanParser()

    def stream() -> None:
        for _ in range(1000):
            assert parser.feed(b"A" * 1000) == []

    # A hundredth of the stream: a line, and what the interpreter keeps for itself.
    assert kept_bytes(stream) < 10_000
    (fault,) = parser.feed(b"\r")
    assert isinstance(fault, SlcanFault)
    assert fault.reason == "too-long"


def test_opening_commands_listen_only() -> None:
    assert listen_only_commands(500_000) == (b"C\r", b"S6\r", b"L\r")


def test_an_unknown_bit_rate_is_refused_with_the_known_ones() -> None:
    with pytest.raises(CanError, match=r"wanted a bit rate .*1000000\), got 300000"):
        bitrate_command(300_000)


@pytest.mark.parametrize(
    ("can_id", "data", "extended"), [(0x800, b"", False), (-1, b"", True), (1, bytes(9), False)]
)
def test_impossible_frames_are_not_encoded(can_id: int, data: bytes, extended: bool) -> None:
    with pytest.raises(CanError, match="wanted"):
        encode_slcan(can_id, data, extended=extended)
