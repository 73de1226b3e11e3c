"""Capacity and link arithmetic against frames that were really composed."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.board import (
    BLOCK_TRANSFER_LIMIT_S,
    MAX_PAYLOAD,
    BoardDictionary,
    Channel,
    Configuration,
    FrameType,
    Header,
    IepeState,
    ReplyCode,
    Samples,
    Slope,
    block_bytes,
    block_wire_bytes,
    encode_frame,
    encode_samples,
    pack_counts,
    refusal,
    samples_per_frame,
    stream_bytes_per_s,
)

CHANNELS = tuple(
    Channel(
        name=f"channel {i}",
        quantity="force",
        unit="N",
        scale=1.0,
        full_scale=1.0,
        iepe=IepeState.OFF,
        highpass_hz=0.0,
        serial_number="",
        calibration_date="",
        teds=b"",
    )
    for i in range(4)
)
BOARD = BoardDictionary(
    board_id="",
    firmware="",
    link_bytes_per_s=1_000_000,
    block_capacity=1_000_000,
    tick_hz=1_000_000,
    filter_group_delay_samples=0.0,
    channels=CHANNELS,
)
CONFIGURATION = Configuration(
    rate_hz=Fraction(51_200, 31),
    channel_mask=0b1111,
    trigger_channel=0,
    trigger_level_counts=100,
    slope=Slope.RISING,
    pretrigger=100,
    block_length=2048,
    stream=True,
)


def data_frame(n_samples: int, n_channels: int, block_id: int | None) -> bytes:
    """A frame whose counts hold no zero byte, where COBS adds most."""
    counts = np.full((n_samples, n_channels), 0x010101, dtype=np.int32)
    kind = FrameType.STREAM if block_id is None else FrameType.BLOCK_DATA
    payload = encode_samples(Samples(first_sample=0, counts=counts, block_id=block_id))
    return encode_frame(Header(type=kind, session=1, sequence=0), payload)


@pytest.mark.parametrize("n_channels", range(1, 33))
def test_a_full_data_frame_fits_a_payload(n_channels):
    n_samples = samples_per_frame(n_channels)
    assert len(data_frame(n_samples, n_channels, 1)) > 0
    assert n_samples == 64 or 8 + 3 * n_channels * (n_samples + 1) > MAX_PAYLOAD


@given(st.integers(1, 2000), st.integers(1, 15))
def test_the_wire_bytes_of_a_block_bound_what_is_sent_within_its_zero_bytes(length, mask):
    configuration = replace(CONFIGURATION, block_length=length, channel_mask=mask)
    c = mask.bit_count()
    sizes = [min(64, length - start) for start in range(0, length, 64)]
    sent = sum(len(data_frame(n, c, 7)) for n in sizes)
    # The bound counts one COBS byte per 254 begun. The header's zeros split the first run, which
    # can save one byte a frame and no more.
    assert sent <= block_wire_bytes(configuration) <= sent + len(sizes)
    assert block_bytes(configuration) == len(pack_counts(np.zeros((length, c), dtype=np.int32)))


def test_four_channels_at_51200_hz_need_the_link_of_the_specification():
    # w(4 + 3*4*64) = 36 + 772 + ceil(808 / 254) + 2 = 814 bytes, 51200 / 64 = 800 frames a second.
    fast = replace(CONFIGURATION, rate_hz=Fraction(51_200))
    assert stream_bytes_per_s(fast) == 814 * 800
    assert refusal(fast, replace(BOARD, link_bytes_per_s=814 * 800)) is None
    code, reason = refusal(fast, replace(BOARD, link_bytes_per_s=814 * 800 - 1)) or (None, "")
    assert code is ReplyCode.LINK
    assert "651200" in reason
    assert "651199" in reason


def test_without_preview_the_link_need_only_carry_blocks():
    fast = replace(CONFIGURATION, rate_hz=Fraction(51_200), stream=False)
    enough = -(-block_wire_bytes(fast) // BLOCK_TRANSFER_LIMIT_S)
    assert refusal(fast, replace(BOARD, link_bytes_per_s=enough)) is None
    code, reason = refusal(fast, replace(BOARD, link_bytes_per_s=enough - 1)) or (None, "")
    assert code is ReplyCode.LINK
    assert str(block_wire_bytes(fast)) in reason


def test_a_block_beyond_the_buffer_is_refused_with_both_numbers():
    assert refusal(CONFIGURATION, replace(BOARD, block_capacity=24_576)) is None
    assert refusal(CONFIGURATION, replace(BOARD, block_capacity=24_575)) == (
        ReplyCode.CAPACITY,
        "2048 samples x 4 channels x 3 B = 24576 B, block buffer 24575 B",
    )


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"channel_mask": 0}, "mask"),
        ({"channel_mask": 0b10001}, "mask"),
        ({"channel_mask": 0b0010}, "trigger channel 0"),
        ({"trigger_channel": 4}, "trigger channel 4"),
        ({"trigger_channel": -1}, "trigger channel -1"),
        ({"trigger_level_counts": 1 << 23}, "8388608"),
        ({"trigger_level_counts": -(1 << 23)}, "-8388608"),
        ({"pretrigger": 2048}, "pre-trigger 2048"),
        ({"pretrigger": 0, "block_length": 0}, "block of 0"),
    ],
)
def test_an_impossible_value_is_named(change, word):
    code, reason = refusal(replace(CONFIGURATION, **change), BOARD) or (None, "")
    assert code is ReplyCode.BAD_VALUE
    assert word in reason
