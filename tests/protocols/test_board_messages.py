"""Payloads of commands, replies and blocks."""

import contextlib
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.board import (
    BlockInfo,
    BoardState,
    BoardStatus,
    Configuration,
    ReplyCode,
    Slope,
    decode_block_info,
    decode_configuration,
    decode_release,
    decode_reply,
    decode_resend,
    decode_status,
    encode_block_info,
    encode_configuration,
    encode_release,
    encode_reply,
    encode_resend,
    encode_status,
    wire_size,
)
from armodal.protocols.errors import FrameError

U8, U32, U64 = (st.integers(0, 2**bits - 1) for bits in (8, 32, 64))
POSITIVE_U32 = st.integers(1, 2**32 - 1)
CONFIGURATIONS = st.builds(
    Configuration,
    rate_hz=st.builds(Fraction, POSITIVE_U32, POSITIVE_U32),
    channel_mask=U32,
    trigger_channel=U8,
    trigger_level_counts=st.integers(-(2**31), 2**31 - 1),
    slope=st.sampled_from(Slope),
    pretrigger=U32,
    block_length=U32,
    stream=st.booleans(),
)
STATUSES = st.builds(
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


@given(CONFIGURATIONS)
def test_a_configuration_survives(configuration):
    assert decode_configuration(encode_configuration(configuration)) == configuration


def test_a_rate_of_51200_over_31_is_exact():
    assert encode_configuration(
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
    configuration = decode_configuration(b"\1\0\0\0" * 2 + bytes(20))
    assert len(encode_configuration(configuration)) == 28
    assert len(encode_resend(1, 2, 3)) == 12
    assert len(encode_release(1)) == 4
    assert len(encode_block_info(BLOCK)) == 32
    assert len(encode_status(STATUS)) == len(encode_reply(ReplyCode.OK)) + 37
    # CONFIGURE is the longest command, 67 bytes with both delimiters.
    assert wire_size(28) == 67


@given(STATUSES)
def test_a_status_survives(status):
    assert decode_status(encode_status(status)) == status


def test_a_refused_status_says_why():
    with pytest.raises(FrameError, match="WRONG_SESSION rebooted"):
        decode_status(encode_reply(ReplyCode.WRONG_SESSION, "rebooted"))


@given(st.sampled_from(ReplyCode), st.text())
def test_a_reason_survives_up_to_255_bytes(code, reason):
    found_code, found = decode_reply(encode_reply(code, reason))
    assert found_code is code
    assert len(found.encode()) <= 255
    assert reason.startswith(found)
    # A UTF-8 character has at most 4 bytes, so the cut loses fewer than that.
    assert found == reason or len(found.encode()) > 255 - 4


@given(POSITIVE_U32, U32, U32)
def test_resend_and_release_survive(block_id, first, count):
    assert decode_resend(encode_resend(block_id, first, count)) == (block_id, first, count)
    assert decode_release(encode_release(block_id)) == block_id


@given(POSITIVE_U32, st.integers(0, 2**60), POSITIVE_U32, U64, st.data())
def test_a_block_info_survives(block_id, first, length, ticks, data):
    info = BlockInfo(
        block_id=block_id,
        first_sample=first,
        length=length,
        trigger_sample=first + data.draw(st.integers(0, length - 1)),
        trigger_ticks=ticks,
    )
    assert decode_block_info(encode_block_info(info)) == info


@pytest.mark.parametrize("trigger", [99, 150])
def test_a_trigger_outside_its_block_is_refused(trigger):
    with pytest.raises(FrameError, match=f"trigger sample {trigger}"):
        decode_block_info(encode_block_info(replace(BLOCK, trigger_sample=trigger)))


@pytest.mark.parametrize(
    "encode",
    [
        lambda: encode_block_info(replace(BLOCK, length=2**32)),
        lambda: encode_status(replace(STATUS, next_sample=-1)),
        lambda: encode_resend(-1, 0, 0),
        lambda: encode_release(2**32),
    ],
)
def test_a_value_that_does_not_fit_is_refused(encode):
    with pytest.raises(FrameError, match="does not fit"):
        encode()


@pytest.mark.parametrize(
    "decode",
    [
        decode_configuration,
        decode_status,
        decode_block_info,
        decode_reply,
        decode_resend,
        decode_release,
    ],
)
@given(data=st.binary(max_size=64) | st.binary(max_size=64).map(lambda tail: b"\0\0" + tail))
def test_any_payload_decodes_or_raises_frame_error(decode, data):
    with contextlib.suppress(FrameError):
        decode(data)
