"""What comes over a line, to be made wrong: frames of a board, lines of a bus adapter."""

import struct
import zlib
from contextlib import suppress
from fractions import Fraction
from functools import partial

import numpy as np
from cobs import cobs
from support.mutate import mutated

from armodal.protocols.arm.files import load_arm
from armodal.protocols.board.codec import (
    FrameDecoder,
    encode_frame,
)
from armodal.protocols.board.messages import (
    decode_answer,
    decode_dictionary,
    decode_payload,
    decode_reply,
    decode_samples,
    encode_answer,
    encode_dictionary,
    encode_payload,
    encode_reply,
    encode_samples,
    hello_fragments,
    join_hello,
)
from armodal.protocols.board.records import (
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Channel,
    Configuration,
    FrameType,
    Header,
    IepeState,
    Release,
    ReplyCode,
    Resend,
    Samples,
    Slope,
)
from armodal.protocols.can_database import CanDecoder, CanEncoder
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import ArmodalError
from armodal.protocols.slcan import SlcanParser, encode_slcan


def example_dictionary():
    def channel(name, quantity):
        return Channel(
            name=name,
            quantity=quantity,
            unit="N" if quantity == "force" else "m/s^2",
            scale=1e-4,
            full_scale=800.0,
            iepe=IepeState.OK,
            highpass_hz=0.5,
            serial_number="SN 1",
            calibration_date="2026-01-31",
            teds=bytes(range(16)),
        )

    return BoardDictionary(
        board_id="board",
        firmware="1",
        link_bytes_per_s=1_000_000,
        block_capacity=1 << 19,
        tick_hz=1_000_000,
        filter_group_delay_samples=16.0,
        channels=(
            channel("hammer", "force"),
            *(channel(f"acc_{a}", "acceleration") for a in "xyz"),
        ),
    )


def board_payloads():
    """Return (type, payload) of every message."""
    hello = hello_fragments(encode_dictionary(example_dictionary()))
    counts = np.arange(-80, 80, dtype=np.int32).reshape(-1, 4) * 5000
    status = BoardStatus(
        state=BoardState.RUNNING, next_sequence=7, next_sample=1 << 40, buffered_blocks=2,
        oldest_block=3, stream_samples_dropped=5, triggers_missed=1, adc_overruns=0,
    )  # fmt: skip
    configuration = Configuration(
        rate_hz=Fraction(51200, 31), channel_mask=15, trigger_channel=0, trigger_level_counts=3000,
        slope=Slope.RISING, pretrigger=64, block_length=256, stream=True,
    )  # fmt: skip
    block = Samples(first_sample=1000, counts=counts, block_id=3)
    info = BlockInfo(
        block_id=3, first_sample=1000, length=256, trigger_sample=1064, trigger_ticks=1 << 33
    )
    return [
        (FrameType.CONFIGURE, encode_payload(configuration)),
        (FrameType.RESEND, encode_payload(Resend(block_id=3, first=0, count=64))),
        (FrameType.RELEASE, encode_payload(Release(block_id=3))),
        *((FrameType.HELLO_REPLY, fragment) for fragment in hello),
        (FrameType.STATUS_REPLY, encode_answer(status)),
        (FrameType.CONFIGURE_REPLY, encode_reply(ReplyCode.BAD_VALUE, "rate cannot be made")),
        (FrameType.STREAM, encode_samples(Samples(first_sample=64, counts=counts))),
        (FrameType.BLOCK_READY, encode_payload(info)),
        (FrameType.BLOCK_DATA, encode_samples(block)),
    ]  # fmt: skip


def board_stream():
    return b"".join(
        encode_frame(
            Header(type=kind, session=1, sequence=i, dictionary_hash=2, first_sample=64), payload
        )
        for i, (kind, payload) in enumerate(board_payloads())
    )


def mutate_frames(data, rng, others):
    """Change the line's bytes, or what is in a frame, with a CRC that fits again."""
    if rng.random() < 0.4:
        return mutated(data, rng, others=others)
    frames = [f for f in data.split(b"\0") if f]
    at = int(rng.integers(len(frames)))
    with suppress(cobs.DecodeError):
        body = mutated(cobs.decode(frames[at])[:-4], rng, largest=3, limit=4096)
        if rng.random() < 0.7:
            body = b"\x01" + body[1:]
        frames[at] = cobs.encode(body + struct.pack("<I", zlib.crc32(body)))
    return b"\0" + b"\0\0".join(frames) + b"\0"


PAYLOADS = {
    FrameType.CONFIGURE: partial(decode_payload, Configuration),
    FrameType.RESEND: partial(decode_payload, Resend),
    FrameType.RELEASE: partial(decode_payload, Release),
    FrameType.STATUS_REPLY: partial(decode_answer, BoardStatus),
    FrameType.BLOCK_READY: partial(decode_payload, BlockInfo),
}


def decode_board(data):
    frames = FrameDecoder().feed(data)
    fragments = []
    for frame in frames:
        with suppress(ArmodalError):
            kind = frame.header.type
            if kind in {FrameType.STREAM, FrameType.BLOCK_DATA}:
                decode_samples(frame)
            elif kind is FrameType.HELLO_REPLY:
                fragments.append(frame.payload)
                whole = join_hello(fragments)
                if whole is not None:
                    decode_dictionary(whole)
            else:
                PAYLOADS.get(kind, decode_reply)(frame.payload)


# Bus


def slcan_lines():
    arm = load_arm("rv4frl")
    encoder = CanEncoder(arm.can)
    names = [joint.name for joint in arm.joints]
    lines = b""
    for counter in range(8):
        frames = encoder.encode(dict.fromkeys(names, 0.1 * counter), drive_state=2, counter=counter)
        lines += b"".join(encode_slcan(f.can_id, f.data) for f in frames)
    return lines + b"F00\rV1013\rNS042\r\x07T00000123411\rr1234\rR000000010\rz\rZ\r"


def bus_decoder():
    arm = load_arm("rv4frl")

    def decode(data):
        decoder = CanDecoder(arm.can)
        for item in SlcanParser().feed(data):
            if isinstance(item, CanFrame):
                with suppress(ArmodalError):
                    decoder.decode(item)

    return decode
