"""Payloads of commands, replies and blocks."""

import contextlib
from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.any_record import records

from armodal.protocols.board import (
    BlockInfo,
    BoardState,
    BoardStatus,
    Configuration,
    Release,
    ReplyCode,
    Resend,
    Slope,
    decode_answer,
    decode_payload,
    decode_reply,
    encode_answer,
    encode_payload,
    encode_reply,
    wire_size,
)
from armodal.protocols.errors import FrameError

BLOCK = BlockInfo(block_id=1, first_sample=100, length=50, trigger_sample=110, trigger_ticks=9)
STATUS = BoardStatus(
    state=BoardState.IDLE,
    next_sequence=0,
    next_sample=0,
    buffered_blocks=0,
    oldest_block=0,
    stream_samples_dropped=0,
    triggers_missed=0,
    adc_overruns=0,
)


def test_a_rate_of_51200_over_31_is_exact():
    assert encode_payload(
        Configuration(
            rate_hz=Fraction(51_200, 31),
            channel_mask=1,
            trigger_channel=0,
            trigger_level_counts=1,
            slope=Slope.RISING,
            pretrigger=0,
            block_length=1,
            stream=False,
        )
    ).startswith((51_200).to_bytes(4, "little") + (31).to_bytes(4, "little"))


def test_payloads_have_the_sizes_of_the_document():
    configuration = decode_payload(Configuration, b"\1\0\0\0" * 2 + bytes(20))
    assert len(encode_payload(configuration)) == 28
    assert len(encode_payload(Resend(block_id=1, first=2, count=3))) == 12
    assert len(encode_payload(Release(block_id=1))) == 4
    assert len(encode_payload(BLOCK)) == 32
    assert len(encode_answer(STATUS)) == len(encode_reply(ReplyCode.OK)) + 37
    # CONFIGURE is the longest command, 67 bytes with both delimiters.
    assert wire_size(28) == 67


@given(records(BoardStatus))
def test_a_status_survives_in_its_reply(status):
    assert decode_answer(BoardStatus, encode_answer(status)) == status


def test_a_refused_status_says_why():
    with pytest.raises(FrameError, match="WRONG_SESSION rebooted"):
        decode_answer(BoardStatus, encode_reply(ReplyCode.WRONG_SESSION, "rebooted"))


@given(st.sampled_from(ReplyCode), st.text())
def test_a_reason_survives_up_to_255_bytes(code, reason):
    found_code, found = decode_reply(encode_reply(code, reason))
    assert found_code is code
    assert len(found.encode()) <= 255
    assert reason.startswith(found)
    # A UTF-8 character has at most 4 bytes, so the cut loses fewer than that.
    assert found == reason or len(found.encode()) > 255 - 4


@pytest.mark.parametrize("trigger", [99, 150])
def test_a_trigger_outside_its_block_is_refused(trigger):
    with pytest.raises(FrameError, match=f"trigger_sample={trigger}"):
        decode_payload(BlockInfo, encode_payload(replace(BLOCK, trigger_sample=trigger)))


@pytest.mark.parametrize(
    "encode",
    [
        lambda: encode_payload(replace(BLOCK, length=2**32)),
        lambda: encode_answer(replace(STATUS, next_sample=-1)),
        lambda: encode_payload(Resend(block_id=-1, first=0, count=0)),
        lambda: encode_payload(Release(block_id=2**32)),
    ],
)
def test_a_value_that_does_not_fit_is_refused(encode):
    with pytest.raises(FrameError, match="does not fit"):
        encode()


@pytest.mark.parametrize(
    "decode",
    [
        partial(decode_payload, Configuration),
        partial(decode_answer, BoardStatus),
        partial(decode_payload, BlockInfo),
        decode_reply,
        partial(decode_payload, Resend),
        partial(decode_payload, Release),
    ],
)
@given(data=st.binary(max_size=64) | st.binary(max_size=64).map(lambda tail: b"\0\0" + tail))
def test_any_payload_decodes_or_raises_frame_error(decode, data):
    with contextlib.suppress(FrameError):
        decode(data)
