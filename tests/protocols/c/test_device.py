"""Commands of the C board: every state, every refusal, and a link that is busy."""

from dataclasses import replace
from fractions import Fraction
from itertools import cycle, islice

import pytest
from cobs import cobs
from hypothesis import given
from hypothesis import strategies as st
from support.c_device import FFI, SESSION, C, Device, dictionary_of, sealed

from armodal.protocols.board import (
    BoardState,
    Configuration,
    FrameType,
    Release,
    ReplyCode,
    Resend,
    SequenceTracker,
    Slope,
    decode_reply,
    decode_samples,
    dictionary_hash,
    encode_payload,
    join_hello,
    wire_size,
)
from armodal.protocols.c.device_board import DeviceBoard, PortingLayer

WANTED = Configuration(
    rate_hz=Fraction(1024),
    channel_mask=3,
    trigger_channel=0,
    trigger_level_counts=1,
    slope=Slope.RISING,
    pretrigger=2,
    block_length=100,
    stream=False,
)
CONFIGURE = encode_payload(WANTED)
HIT = [[0, 0], [0, 0], [1, 0], *([[0, 0]] * 97)]
BIG = dictionary_of(32, board_id="x" * 255)  # more than two fragments


def test_the_board_is_silent_until_it_is_asked():
    device = Device()
    assert device.init == C.AB_INIT_OK
    assert not device.poll()
    assert device.frames == []


@pytest.mark.parametrize("version", [1, 2, 0, 255])
def test_hello_of_any_version_is_answered_with_the_dictionary(version):
    device = Device(BIG)
    replies = device.ask(FrameType.HELLO, version=version, session=0, tag=77)
    assert {frame.header.type for frame in replies} == {FrameType.HELLO_REPLY}
    assert {(f.header.tag, f.header.session) for f in replies} == {(77, SESSION)}
    assert join_hello([frame.payload for frame in replies]) == device.encoded


@pytest.mark.parametrize("kind", [FrameType.START, FrameType.STATUS, 0x42])
def test_other_frames_of_another_version_are_dropped(kind):
    assert Device().ask(kind, version=2) == []


@pytest.mark.parametrize("kind", [0x80, 0x81, 0x90, 0x93, 0xFF])
def test_frames_of_a_board_are_dropped(kind):
    assert Device().ask(kind) == []


UNKNOWN = sorted(set(range(0x80)) - set(FrameType))


@pytest.mark.parametrize("kind", [*UNKNOWN[:2], 0x42, UNKNOWN[-1]])
def test_an_unknown_command_is_answered_as_such_with_its_type(kind):
    wires = []
    device = Device()
    device.decoder.feed = lambda data: wires.append(data) or []
    assert device.ask(kind) == []
    # 00, code, version 1, type: neither is zero, so COBS leaves them where they are.
    assert wires[0][3] == kind | 0x80
    assert bytes([ReplyCode.UNKNOWN_COMMAND]) in wires[0]


def asked_of_the_board(answer):
    """What a command of no type of the library comes to, where the board says what it is."""
    wires = []
    layer = PortingLayer(
        send=lambda frame: wires.append(frame) or True,
        ticks=lambda: 0,
        rate_refusal=lambda _rate: "",
        start=lambda _rate: None,
        stop=lambda: None,
        answer=answer,
    )
    board = DeviceBoard(dictionary_of(), session=SESSION, layer=layer)
    board.receive(sealed(1, 0x42, b"\x05\x06"))
    board.poll()
    return wires


def test_a_command_that_only_the_board_knows_is_handed_to_it():
    asked = []

    def answer(*command):
        asked.append(command)
        return Release(block_id=7)

    (wire,) = asked_of_the_board(answer)
    assert asked == [(0x42, b"\x05\x06")]
    body = cobs.decode(wire.strip(b"\0"))
    assert (body[1], body[32]) == (0xC2, ReplyCode.OK)


def test_a_board_s_refusal_stands_in_the_answer():
    device = Device()

    def refuse(_context, _kind, _payload, _n, _answer, reason, _size):
        FFI.memmove(reason, b"no sensor\0", 10)
        return ReplyCode.WRONG_STATE

    call = "ab_code(void *, uint8_t, const uint8_t *, size_t, uint8_t *, char *, size_t)"
    device.keep.append(FFI.callback(call, refuse))
    device.config.port.command = device.keep[-1]
    wires = []
    device.decoder.feed = lambda data: wires.append(data) or []
    device.ask(0x42)
    assert bytes([ReplyCode.WRONG_STATE, 9]) + b"no sensor" in wires[0]


@pytest.mark.parametrize("kind", list(FrameType)[1:7])
def test_a_command_for_another_session_is_not_carried_out(kind):
    device = Device()
    assert device.code(kind, session=SESSION ^ 1) is ReplyCode.WRONG_SESSION
    assert device.status().state is BoardState.IDLE


def in_state(state):
    device = Device()
    if state is not BoardState.IDLE:
        assert device.code(FrameType.CONFIGURE, CONFIGURE) is ReplyCode.OK
    if state is BoardState.RUNNING:
        assert device.code(FrameType.START) is ReplyCode.OK
    return device


# Section 4.1, row by row: code and state after it.
IDLE, CONFIGURED, RUNNING = BoardState
OK, WRONG = ReplyCode.OK, ReplyCode.WRONG_STATE


@pytest.mark.parametrize(
    ("kind", "state", "code", "after"),
    [
        (FrameType.CONFIGURE, IDLE, OK, CONFIGURED),
        (FrameType.CONFIGURE, CONFIGURED, OK, CONFIGURED),
        (FrameType.CONFIGURE, RUNNING, WRONG, RUNNING),
        (FrameType.START, IDLE, WRONG, IDLE),
        (FrameType.START, CONFIGURED, OK, RUNNING),
        (FrameType.START, RUNNING, WRONG, RUNNING),
        (FrameType.STOP, IDLE, OK, IDLE),
        (FrameType.STOP, CONFIGURED, OK, CONFIGURED),
        (FrameType.STOP, RUNNING, OK, CONFIGURED),
        (FrameType.RESEND, IDLE, ReplyCode.UNKNOWN_BLOCK, IDLE),
        (FrameType.RELEASE, IDLE, ReplyCode.UNKNOWN_BLOCK, IDLE),
    ],
)
def test_the_table_of_states(kind, state, code, after):
    device = in_state(state)
    payloads = {
        FrameType.CONFIGURE: CONFIGURE,
        FrameType.RESEND: encode_payload(Resend(block_id=1, first=0, count=0)),
        FrameType.RELEASE: encode_payload(Release(block_id=1)),
    }
    assert device.code(kind, payloads.get(kind, b"")) is code
    assert device.status().state is after


@pytest.mark.parametrize("kind", list(FrameType)[1:7])
def test_a_malformed_payload_is_a_bad_value_and_changes_nothing(kind):
    device = in_state(BoardState.CONFIGURED)
    assert device.code(kind, b"\x01") is ReplyCode.BAD_VALUE
    assert device.status().state is BoardState.CONFIGURED


def test_a_rate_the_converter_cannot_make_is_refused_in_its_words():
    device = in_state(BoardState.CONFIGURED)
    seven = encode_payload(replace(WANTED, rate_hz=Fraction(7)))
    (reply,) = device.ask(FrameType.CONFIGURE, seven)
    assert decode_reply(reply.payload) == (ReplyCode.BAD_VALUE, "not 7 Hz")
    assert device.code(FrameType.START) is ReplyCode.OK


def test_the_resend_queue_takes_eight_ranges_and_says_when_it_is_full():
    device = in_state(BoardState.RUNNING)
    device.feed(HIT)
    device.poll()
    for _ in range(20):
        # Room for the frame that waits and for one answer: block data go out more slowly than
        # they are asked for, three frames for each range of this block.
        waiting = device.board.transmit_end - device.board.transmit_at
        device.room = waiting + wire_size(2)
        device.receive(
            sealed(1, FrameType.RESEND, encode_payload(Resend(block_id=1, first=0, count=100)))
        )
        device.poll()
    assert device.board.n_resend == 8
    device.room = None
    device.poll()
    codes = [decode_reply(frame.payload)[0] for frame in device.of(FrameType.RESEND_REPLY)]
    assert codes[:9] == [ReplyCode.OK] * 9
    assert set(codes) == {ReplyCode.OK, ReplyCode.WRONG_STATE}
    assert len(device.of(FrameType.BLOCK_READY)) == 1 + codes.count(ReplyCode.OK)
    assert len(device.of(FrameType.BLOCK_DATA)) == 2 * (1 + codes.count(ReplyCode.OK))


def test_release_takes_back_what_is_queued_of_its_block_and_nothing_else():
    device = in_state(BoardState.RUNNING)
    device.room = 0
    device.feed(HIT * 2)
    device.poll()  # BLOCK_READY of block 1 waits for the line
    device.receive(sealed(1, FrameType.RELEASE, encode_payload(Release(block_id=1))))
    device.room = None
    device.poll()
    assert {f.payload[4] for f in device.of(FrameType.BLOCK_DATA)} == {2}


def test_release_takes_the_ranges_of_its_block_out_of_the_queue_and_no_others():
    device = in_state(BoardState.RUNNING)
    device.feed(HIT * 2)
    device.poll()
    device.frames.clear()
    # One answer a turn: the first frame of data that is sent again waits on the line.
    for kind, payload in [
        (FrameType.RESEND, encode_payload(Resend(block_id=2, first=0, count=10))),
        (FrameType.RESEND, encode_payload(Resend(block_id=1, first=0, count=10))),
        (FrameType.RESEND, encode_payload(Resend(block_id=2, first=20, count=10))),
        (FrameType.RELEASE, encode_payload(Release(block_id=1))),
    ]:
        waiting = device.board.transmit_end - device.board.transmit_at
        device.room = waiting + wire_size(2)
        device.receive(sealed(1, kind, payload))
    device.room = None
    device.poll()
    sent = [decode_samples(frame) for frame in device.of(FrameType.BLOCK_DATA)]
    assert [samples.block_id for samples in sent] == [2, 2]
    assert sent[1].first_sample - sent[0].first_sample == 20


def test_a_resend_range_is_checked_against_the_block():
    device = in_state(BoardState.RUNNING)
    device.feed(HIT)
    for first, count, code in [
        (0, 100, OK),
        (99, 1, OK),
        (100, 0, OK),
        (99, 2, ReplyCode.BAD_VALUE),
        (2**32 - 1, 2, ReplyCode.BAD_VALUE),
    ]:
        assert (
            device.code(
                FrameType.RESEND, encode_payload(Resend(block_id=1, first=first, count=count))
            )
            is code
        )


@given(room=st.lists(st.integers(0, 40), min_size=1, max_size=40))
def test_a_link_that_takes_a_few_bytes_at_a_time_loses_nothing(room):
    device = Device(BIG)
    commands = b"".join(
        sealed(1, kind, payload, tag=tag)
        for tag, (kind, payload) in enumerate(
            [
                (FrameType.HELLO, b""),
                (FrameType.CONFIGURE, CONFIGURE),
                (FrameType.STATUS, b""),
                (FrameType.START, b""),
                (FrameType.HELLO, b""),
                (FrameType.STOP, b""),
            ]
        )
    )
    for device.room in [*islice(cycle(room), 400), *([500] * 60)]:
        commands = commands[device.receive(commands) :]
        device.poll()
    assert commands == b""
    assert device.decoder.bad_frames == 0
    # The second HELLO came while others waited: every answer whole, and in the order asked.
    tags = [frame.header.tag for frame in device.frames]
    assert tags == sorted(tags)
    assert set(tags) == set(range(6))
    tracker = SequenceTracker()
    assert sum(tracker.check(frame.header) for frame in device.frames) == 0
    hello = [f.payload for f in device.frames if f.header.tag == 4]
    assert join_hello(hello) == device.encoded


@given(st.lists(st.binary(max_size=200), max_size=5))
def test_the_board_answers_after_any_garbage(garbage):
    device = Device()
    for piece in garbage:
        assert device.receive(piece) == len(piece)
    device.receive(b"\x00")
    assert device.ask(FrameType.HELLO)


def test_the_clock_is_read_when_the_answer_is_composed():
    device = Device()
    device.room = 0
    device.receive(sealed(1, FrameType.HELLO))
    device.receive(sealed(1, FrameType.STATUS))
    device.now = 1 << 40
    device.room = None
    device.poll()
    assert [frame.header.ticks for frame in device.frames] == [0, 1 << 40]


def test_status_tells_the_number_of_the_frame_after_it():
    device = Device()
    for _ in range(3):
        status = device.status()
        assert status.next_sequence == device.frames[-1].header.sequence + 1


def test_the_sequence_wraps():
    device = Device()
    device.board.sequence = 2**32 - 1
    assert device.status().next_sequence == 0
    device.status()
    assert [frame.header.sequence for frame in device.frames] == [2**32 - 1, 0]


@pytest.mark.parametrize(
    "small", ["receive_size", "transmit_size", "preview_size", "block_buffer_size", "n_blocks"]
)
def test_a_buffer_that_is_too_small_is_told_at_boot(small):
    device = Device()
    least = {
        "receive_size": 65,
        "transmit_size": 38 + 516 + 3,
        "preview_size": 18 + 192 * 2,
        "block_buffer_size": 65_536,
        "n_blocks": 1,
    }
    for name, size in least.items():
        setattr(device.config, name, size)
    boot = (device.board, device.config, device.keep[1], len(device.encoded), SESSION)
    assert C.ab_init(*boot) == C.AB_INIT_OK
    setattr(device.config, small, least[small] - 1)
    assert C.ab_init(*boot) == C.AB_INIT_BUFFERS


def test_a_dictionary_that_breaks_a_rule_is_told_at_boot():
    device = Device()
    damaged = b"\x02" + device.encoded[1:]
    boot = (device.board, device.config, damaged, len(damaged), SESSION)
    assert C.ab_init(*boot) == C.AB_INIT_DICTIONARY


def test_a_dictionary_with_other_channels_is_refused_and_the_old_one_stays():
    device = Device(dictionary_of(2))
    other = Device(dictionary_of(3)).encoded
    assert C.ab_set_dictionary(device.board, other, len(other)) == C.AB_INIT_DICTIONARY
    assert join_hello([f.payload for f in device.ask(FrameType.HELLO)]) == device.encoded


def test_two_dictionaries_are_never_mixed_in_one_answer():
    device = Device(BIG)
    device.room = 0
    device.receive(sealed(1, FrameType.HELLO, tag=3))  # its first fragment waits for the line
    other = Device(dictionary_of(32, board_id="y" * 255)).encoded
    assert C.ab_set_dictionary(device.board, other, len(other)) == C.AB_INIT_OK
    device.room = None
    device.poll()
    assert len(device.frames) == 1
    replies = device.ask(FrameType.HELLO, tag=4)
    assert join_hello([frame.payload for frame in replies]) == other
    assert replies[0].header.dictionary_hash == dictionary_hash(other)
