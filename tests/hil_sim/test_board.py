import itertools
import os
import select
import struct
import zlib
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from cobs import cobs
from hypothesis import given
from hypothesis import strategies as st
from support.synthetic_laboratory import PEAK_COUNTS, ramp

from armodal.hil_sim.board import LOST_SAMPLES
from armodal.protocols.board.messages import (
    decode_answer,
    decode_dictionary,
    decode_payload,
    decode_reply,
    decode_samples,
    dictionary_hash,
    encode_payload,
    join_hello,
)
from armodal.protocols.board.records import (
    BlockInfo,
    BoardState,
    BoardStatus,
    Configuration,
    FrameType,
    IepeState,
    Overflow,
    Release,
    ReplyCode,
    Resend,
    Slope,
)
from armodal.protocols.board.sequence import (
    SequenceTracker,
)

WANTED = Configuration(
    rate_hz=Fraction(51_200, 31),
    channel_mask=0b1111,
    trigger_channel=0,
    trigger_level_counts=PEAK_COUNTS // 10,
    slope=Slope.RISING,
    pretrigger=100,
    block_length=1000,
    stream=True,
)
PULSE_DELAY = 300  # samples


def connect(bench):
    first = bench.host.ask(FrameType.HELLO)
    bench.host.until(lambda: hello(bench, first.header.tag) is not None)
    return decode_dictionary(hello(bench, first.header.tag))


def hello(bench, tag):
    replies = bench.host.of(FrameType.HELLO_REPLY)
    return join_hello([f.payload for f in replies if f.header.tag == tag])


def code(frame):
    return decode_reply(frame.payload)[0]


def configure(bench, **changes):
    return bench.host.ask(FrameType.CONFIGURE, encode_payload(replace(WANTED, **changes)))


def run(bench, **changes):
    connect(bench)
    assert code(configure(bench, **changes)) is ReplyCode.OK
    assert code(bench.host.ask(FrameType.START)) is ReplyCode.OK


def go_on(bench, seconds, step_s=0.01):
    for _ in range(round(seconds / step_s)):
        bench.time.now_s += step_s
        bench.host.pump()
    while bench.host.pump():
        pass


def status(bench):
    return decode_answer(BoardStatus, bench.host.ask(FrameType.STATUS).payload)


def block_samples(bench):
    return [decode_samples(f) for f in bench.host.of(FrameType.BLOCK_DATA)]


def test_hello_describes_the_board_and_the_hash_is_that_of_the_dictionary(bench):
    dictionary = connect(bench)
    assert [c.name for c in dictionary.channels] == ["hammer", "acc_x", "acc_y", "acc_z"]
    # 5 V over 2^23 counts at 0.25 mV/N.
    assert dictionary.channels[0].scale == pytest.approx(5.0 / 2**23 / 0.00025)
    frame = bench.host.frames[0]
    assert frame.header.dictionary_hash == dictionary_hash(hello(bench, frame.header.tag))


def test_the_stream_carries_every_sample_once_and_in_order(bench):
    run(bench)
    go_on(bench, 1.0)
    samples = [decode_samples(f) for f in bench.host.of(FrameType.STREAM)]
    assert all(len(s.counts) <= 64 for s in samples)
    assert samples[0].first_sample == 0
    joined = np.concatenate([s.counts for s in samples])
    np.testing.assert_array_equal(joined[:, 1:], ramp(0, len(joined)))
    # 1 s at 1651.6 Hz less the 50 ms that section 9 allows a frame to be held back.
    assert len(joined) > 0.95 * 51_200 / 31
    assert status(bench).stream_samples_dropped == 0


def test_a_frame_tells_when_its_first_sample_was_ready(bench):
    run(bench)
    go_on(bench, 1.0)
    frames = bench.host.of(FrameType.STREAM)
    ticks = np.array([f.header.ticks for f in frames], dtype=float)
    first = np.array([f.header.first_sample for f in frames], dtype=float)
    # Device time: the sample clock is the tick clock's. One tick: rounding.
    np.testing.assert_allclose(ticks - ticks[0], first * 31 / 51_200 * 1e6, atol=1.0)


def test_a_trigger_makes_a_block_with_its_pretrigger(bench):
    run(bench)
    at = bench.cell.strike(PULSE_DELAY + 0.25, float(PEAK_COUNTS))
    go_on(bench, 1.0)
    (ready,) = bench.host.of(FrameType.BLOCK_READY)
    info = decode_payload(BlockInfo, ready.payload)
    # The half sine of 20 samples reaches a tenth of its peak at asin(0.1) / pi of its width.
    assert info.trigger_sample == int(np.ceil(at + 20 * np.arcsin(0.1) / np.pi))
    assert info.first_sample == info.trigger_sample - 100
    data = block_samples(bench)
    joined = np.concatenate([s.counts for s in data])
    assert len(joined) == info.length == 1000
    np.testing.assert_array_equal(joined[:, 1:], ramp(info.first_sample, 1000))
    assert [s.first_sample - info.first_sample for s in data] == list(range(0, 1000, 64))


def test_a_held_block_is_resent_in_ranges_until_it_is_released(bench):
    run(bench)
    bench.cell.strike(PULSE_DELAY, float(PEAK_COUNTS))
    go_on(bench, 1.0)
    first = decode_payload(BlockInfo, bench.host.of(FrameType.BLOCK_READY)[0].payload).first_sample
    assert (status(bench).buffered_blocks, status(bench).oldest_block) == (1, 1)
    bench.host.frames.clear()
    assert (
        code(
            bench.host.ask(
                FrameType.RESEND, encode_payload(Resend(block_id=1, first=70, count=130))
            )
        )
        is ReplyCode.OK
    )
    go_on(bench, 0.02)
    assert len(bench.host.of(FrameType.BLOCK_READY)) == 1
    joined = np.concatenate([s.counts for s in block_samples(bench)])
    np.testing.assert_array_equal(joined[:, 1:], ramp(first + 70, 130))
    too_far = bench.host.ask(
        FrameType.RESEND, encode_payload(Resend(block_id=1, first=900, count=101))
    )
    assert code(too_far) is ReplyCode.BAD_VALUE
    for _ in range(2):
        assert (
            code(bench.host.ask(FrameType.RELEASE, encode_payload(Release(block_id=1))))
            is ReplyCode.OK
        )
    assert status(bench).buffered_blocks == 0
    gone = bench.host.ask(FrameType.RESEND, encode_payload(Resend(block_id=1, first=0, count=10)))
    assert code(gone) is ReplyCode.UNKNOWN_BLOCK
    never = bench.host.ask(FrameType.RELEASE, encode_payload(Release(block_id=2)))
    assert code(never) is ReplyCode.UNKNOWN_BLOCK


def test_a_trigger_without_a_free_buffer_is_counted(bench):
    # A block of more than half the capacity leaves room for one.
    run(bench, block_length=30_000, pretrigger=10, stream=False, rate_hz=Fraction(51_200))
    bench.cell.strike(100.0, float(PEAK_COUNTS))
    bench.cell.strike(31_000.0, float(PEAK_COUNTS))
    go_on(bench, 0.9)
    found = status(bench)
    assert (found.buffered_blocks, found.triggers_missed) == (1, 1)
    assert bench.host.frames[-1].header.overflow is Overflow.BLOCK


def test_a_stopped_board_keeps_its_blocks_and_takes_no_samples(bench):
    run(bench)
    bench.cell.strike(PULSE_DELAY, float(PEAK_COUNTS))
    go_on(bench, 1.0)
    assert code(bench.host.ask(FrameType.STOP)) is ReplyCode.OK
    at_stop = status(bench)
    go_on(bench, 0.5)
    assert status(bench).next_sample == at_stop.next_sample
    assert (at_stop.state, at_stop.buffered_blocks) == (BoardState.CONFIGURED, 1)


@pytest.mark.parametrize(
    ("changes", "refused", "words"),
    [
        ({"rate_hz": Fraction(1000)}, ReplyCode.BAD_VALUE, "51200/51 and 51200/52"),
        ({"rate_hz": Fraction(1, 1000)}, ReplyCode.BAD_VALUE, "51200/512"),
        ({"channel_mask": 0b10000}, ReplyCode.BAD_VALUE, "channel mask"),
        ({"trigger_channel": 3, "channel_mask": 0b111}, ReplyCode.BAD_VALUE, "trigger channel"),
        ({"pretrigger": 1000}, ReplyCode.BAD_VALUE, "pre-trigger"),
        ({"block_length": 50_000}, ReplyCode.CAPACITY, "600000 B, block buffer 524288 B"),
    ],
)
def test_configure_refuses_with_the_numbers_and_changes_nothing(bench, changes, refused, words):
    connect(bench)
    configure(bench)
    found, reason = decode_reply(configure(bench, **changes).payload)
    assert found is refused
    assert words in reason
    assert code(bench.host.ask(FrameType.START)) is ReplyCode.OK


def test_configure_refuses_a_stream_the_link_cannot_carry(bench):
    connect(bench)
    dictionary = bench.firmware.dictionary
    bench.firmware.set_dictionary(replace(dictionary, link_bytes_per_s=100_000))
    found, reason = decode_reply(configure(bench, rate_hz=Fraction(51_200)).payload)
    assert found is ReplyCode.LINK
    assert "link 100000 B/s" in reason


def test_commands_out_of_turn_are_refused(bench):
    connect(bench)
    assert code(bench.host.ask(FrameType.START)) is ReplyCode.WRONG_STATE
    assert code(bench.host.ask(FrameType.STOP)) is ReplyCode.OK
    configure(bench)
    bench.host.ask(FrameType.START)
    assert code(bench.host.ask(FrameType.START)) is ReplyCode.WRONG_STATE
    assert code(configure(bench)) is ReplyCode.WRONG_STATE


def test_a_command_for_another_session_is_refused(bench):
    connect(bench)
    configure(bench)
    reply = bench.host.ask(FrameType.START, session=bench.host.session ^ 1)
    assert code(reply) is ReplyCode.WRONG_SESSION
    assert status(bench).state is BoardState.CONFIGURED


def test_a_malformed_payload_is_a_bad_value(bench):
    connect(bench)
    assert code(bench.host.ask(FrameType.CONFIGURE, b"\x01\x02")) is ReplyCode.BAD_VALUE


def test_an_unknown_command_is_answered_and_so_is_a_hello_of_another_version(bench):
    connect(bench)
    body = struct.pack("<BBHIIHHQQ", 1, 0x42, 0, bench.host.session, 0, 0, 5, 0, 0)
    sealed = cobs.encode(body + zlib.crc32(body).to_bytes(4, "little"))
    bench.host.write(b"\x00" + sealed + b"\x00")
    # The Python decoder knows no reply of this type and says so.
    bench.host.until(lambda: "0xc2" in bench.host.decoder.last_error)
    hello_2 = struct.pack("<BBHIIHHQQ", 2, FrameType.HELLO, 0, 0, 0, 0, 6, 0, 0)
    sealed = cobs.encode(hello_2 + zlib.crc32(hello_2).to_bytes(4, "little"))
    bench.host.write(b"\x00" + sealed + b"\x00")
    bench.host.until(lambda: hello(bench, 6) is not None)


def test_what_goes_wrong_in_the_converter_is_not_lost_in_c(bench):
    connect(bench)
    configure(bench)
    # The source is unknown until the converter starts: making it fails.
    bench.make_source = lambda: 1 / 0
    bench.host.send(FrameType.START)
    with pytest.raises(ZeroDivisionError):
        bench.board.step()


def test_a_dictionary_with_other_channels_is_refused(bench):
    fewer = replace(bench.firmware.dictionary, channels=bench.firmware.dictionary.channels[:2])
    with pytest.raises(ValueError, match="as many channels"):
        bench.firmware.set_dictionary(fewer)
    assert len(connect(bench).channels) == 4


@given(garbage=st.binary(max_size=300))
def test_the_board_answers_after_any_garbage(shared_bench, garbage):
    shared_bench.host.write(garbage)
    shared_bench.host.pump()
    # The zero ends whatever stretch the garbage began.
    shared_bench.host.write(b"\x00")
    connect(shared_bench)


def test_sequence_numbers_have_no_gap(bench):
    run(bench)
    bench.cell.strike(PULSE_DELAY, float(PEAK_COUNTS))
    go_on(bench, 1.0)
    tracker = SequenceTracker()
    for frame in bench.host.frames:
        tracker.check(frame.header)
    assert (tracker.missing, tracker.disordered) == (0, 0)
    assert bench.host.decoder.bad_frames == 0


def test_a_host_that_does_not_read_costs_preview_and_nothing_else(bench):
    run(bench, rate_hz=Fraction(51_200))
    bench.cell.strike(20_000.0, float(PEAK_COUNTS))
    for _ in range(100):
        bench.time.now_s += 0.01
        bench.board.step()
        assert bench.board_port.pending < 16 * 1024
    go_on(bench, 0.2)
    found = status(bench)
    assert found.stream_samples_dropped > 0
    assert bench.host.frames[-1].header.overflow is Overflow.STREAM
    joined = np.concatenate([s.counts for s in block_samples(bench)])
    first = decode_payload(BlockInfo, bench.host.of(FrameType.BLOCK_READY)[0].payload).first_sample
    np.testing.assert_array_equal(joined[:, 1:], ramp(first, 1000))
    tracker = SequenceTracker()
    assert sum(tracker.check(f.header) for f in bench.host.frames) == 0


def test_an_opened_sensor_changes_the_hash_in_every_frame(bench):
    run(bench)
    before = bench.host.frames[-1].header.dictionary_hash
    bench.faults.switch("dictionary-change", active=True)
    go_on(bench, 0.1)
    assert bench.host.frames[-1].header.dictionary_hash != before
    assert connect(bench).channels[3].iepe is IepeState.OPEN


def test_lost_samples_jump_the_index_and_say_so(bench):
    run(bench)
    go_on(bench, 0.5)
    bench.faults.switch("adc-gap", active=True)
    go_on(bench, 0.2, step_s=0.1)
    samples = [decode_samples(f) for f in bench.host.of(FrameType.STREAM)]
    jumps = [
        b.first_sample - a.first_sample - len(a.counts) for a, b in itertools.pairwise(samples)
    ]
    assert [j for j in jumps if j] == [LOST_SAMPLES]
    assert status(bench).adc_overruns == 1
    assert bench.host.frames[-1].header.overflow is Overflow.ADC


def test_lost_block_frames_show_in_the_sequence_and_can_be_resent(bench):
    run(bench, stream=False)
    bench.faults.switch("block-loss", active=True)
    bench.cell.strike(PULSE_DELAY, float(PEAK_COUNTS))
    go_on(bench, 1.0)
    # 1000 samples are 16 frames; the seventh and the fourteenth are lost.
    assert len(bench.host.of(FrameType.BLOCK_DATA)) == 14
    tracker = SequenceTracker()
    assert sum(tracker.check(f.header) for f in bench.host.frames) == 2


@pytest.mark.parametrize("fault", ["board-garbage", "board-silence"])
def test_a_faulty_board_never_gives_a_valid_frame(bench, fault):
    bench.faults.switch(fault, active=True)
    bench.host.send(FrameType.HELLO)
    for _ in range(5):
        bench.host.pump()
    assert bench.host.frames == []


def test_the_line_is_raw_and_never_echoes(bench):
    bench.host.write(b"\x03\r\n\x04\x11")
    bench.board.step()
    ready, _, _ = select.select([bench.host.fd], [], [], 0)
    assert not ready


def test_the_board_outlives_a_host_that_goes_away(bench):
    connect(bench)
    bench.host.close()
    for _ in range(3):
        bench.board.step()
    bench.host.fd = os.open(bench.board_port.name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    connect(bench)
