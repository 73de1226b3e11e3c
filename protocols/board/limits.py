"""What a board must refuse: the arithmetic of capacity and link, the same on both sides.

Specified in `docs/board-protocol.md`, section 6.
"""

from __future__ import annotations

from fractions import Fraction

from armodal.protocols.board.codec import MAX_PAYLOAD, wire_size
from armodal.protocols.board.messages import BLOCK_HEAD_SIZE, STREAM_HEAD_SIZE
from armodal.protocols.board.records import BoardDictionary, Configuration, ReplyCode
from armodal.protocols.board.samples import BYTES_PER_COUNT, COUNT_MAX, COUNT_MIN

__all__ = [
    "BLOCK_TRANSFER_LIMIT_S",
    "block_bytes",
    "block_wire_bytes",
    "refusal",
    "samples_per_frame",
    "stream_bytes_per_s",
]

BLOCK_TRANSFER_LIMIT_S = 10
_NOMINAL_SAMPLES = 64


def samples_per_frame(n_channels: int) -> int:
    """Samples in a full STREAM or BLOCK_DATA frame: 64, fewer where they would not fit.

    >>> samples_per_frame(4), samples_per_frame(32)
    (64, 21)
    """
    return min(_NOMINAL_SAMPLES, (MAX_PAYLOAD - BLOCK_HEAD_SIZE) // (BYTES_PER_COUNT * n_channels))


def block_bytes(configuration: Configuration) -> int:
    """Bytes of block buffer one block takes."""
    return BYTES_PER_COUNT * _n_channels(configuration) * configuration.block_length


def block_wire_bytes(configuration: Configuration) -> int:
    """Most bytes the BLOCK_DATA frames of one block take on the wire."""
    n_channels = _n_channels(configuration)
    full, left = divmod(configuration.block_length, samples_per_frame(n_channels))
    size = full * _data_frame_bytes(BLOCK_HEAD_SIZE, samples_per_frame(n_channels), n_channels)
    return size + (_data_frame_bytes(BLOCK_HEAD_SIZE, left, n_channels) if left else 0)


def stream_bytes_per_s(configuration: Configuration) -> Fraction:
    """Most bytes per second the preview stream takes on the wire, in full frames."""
    n_channels = _n_channels(configuration)
    n_samples = samples_per_frame(n_channels)
    frames_hz = configuration.rate_hz / n_samples
    return frames_hz * _data_frame_bytes(STREAM_HEAD_SIZE, n_samples, n_channels)


def _n_channels(configuration: Configuration) -> int:
    return configuration.channel_mask.bit_count()


def _data_frame_bytes(prefix: int, n_samples: int, n_channels: int) -> int:
    return wire_size(prefix + BYTES_PER_COUNT * n_samples * n_channels)


def refusal(
    configuration: Configuration, dictionary: BoardDictionary
) -> tuple[ReplyCode, str] | None:
    """Why a board with this dictionary must refuse a configuration; None if it need not.

    Which sample rates its converter can make, the board knows beside this.
    """
    return _bad_value(configuration, len(dictionary.channels)) or _insufficient(
        configuration, dictionary
    )


def _bad_value(configuration: Configuration, n_channels: int) -> tuple[ReplyCode, str] | None:
    mask, trigger = configuration.channel_mask, configuration.trigger_channel
    level = configuration.trigger_level_counts
    if not 0 < mask < 1 << n_channels:
        text = f"channel mask 0x{mask:x} must name some of {n_channels} channels and no other"
    elif not 0 <= trigger < n_channels or not mask >> trigger & 1:
        text = f"trigger channel {trigger} is not in channel mask 0x{mask:x}"
    elif not COUNT_MIN < level <= COUNT_MAX:
        text = f"trigger level {level} counts is outside {COUNT_MIN + 1}...{COUNT_MAX}"
    elif not 0 <= configuration.pretrigger < configuration.block_length:
        text = (
            f"pre-trigger {configuration.pretrigger} must be shorter than "
            f"the block of {configuration.block_length} samples"
        )
    else:
        return None
    return ReplyCode.BAD_VALUE, text


def _insufficient(
    configuration: Configuration, dictionary: BoardDictionary
) -> tuple[ReplyCode, str] | None:
    n_channels, link = _n_channels(configuration), dictionary.link_bytes_per_s
    needed = block_bytes(configuration)
    if needed > dictionary.block_capacity:
        return ReplyCode.CAPACITY, (
            f"{configuration.block_length} samples x {n_channels} channels x {BYTES_PER_COUNT} B "
            f"= {needed} B, block buffer {dictionary.block_capacity} B"
        )
    stream = stream_bytes_per_s(configuration)
    if configuration.stream and stream > link:
        return ReplyCode.LINK, (
            f"stream of {n_channels} channels at {float(configuration.rate_hz):.1f} Hz takes "
            f"{float(stream):.0f} B/s, link {link} B/s"
        )
    wire = block_wire_bytes(configuration)
    if wire > BLOCK_TRANSFER_LIMIT_S * link:
        return ReplyCode.LINK, (
            f"block of {wire} B on the wire takes {wire / link:.1f} s at {link} B/s, "
            f"limit {BLOCK_TRANSFER_LIMIT_S} s"
        )
    return None
