from __future__ import annotations

import pytest

from armodal.daq.board_link import BoardLink
from armodal.daq.clock import SystemClock
from armodal.daq.serial_port import SerialPort
from armodal.protocols.board.messages import encode_reply
from armodal.protocols.board.records import FrameType, ReplyCode
from armodal.protocols.errors import BoardRefusedError, DeviceLostError, DeviceTimeoutError


@pytest.fixture
def port(board):
    port = SerialPort(board.name)
    yield port
    port.close()


@pytest.fixture
def link(port):
    return BoardLink(port, SystemClock(), reply_timeout_s=0.05, give_up_wall_s=0.0)


def test_the_board_describes_itself(link, board, fakes):
    found = link.hello()
    assert found.dictionary == fakes["dictionary"]()
    assert found.session == board.session


def test_a_command_whose_reply_was_lost_is_sent_again(link, board):
    link.hello()
    link.status()  # the first frame after HELLO only sets what is expected
    lost: list[int] = []
    board.drop = lambda kind, first: (
        kind is FrameType.STOP_REPLY and not lost and not lost.append(1)
    )
    link.stop()
    assert lost
    assert link.frames_lost == 1


def test_a_start_whose_reply_was_lost_is_none_the_worse(link, board, plan):
    link.hello()
    answer = board.answer
    starts: list[int] = []

    def twice(frame):
        if frame.header.type is FrameType.START:
            starts.append(1)
            if len(starts) > 1:
                reply = encode_reply(ReplyCode.WRONG_STATE, "running")
                board.send(FrameType.START_REPLY, reply, tag=frame.header.tag)
                return
        answer(frame)

    board.answer = twice
    board.drop = lambda kind, first: kind is FrameType.START_REPLY and len(starts) == 1
    link.start()
    assert len(starts) == 2


def test_a_refusal_carries_the_boards_reason(link, board):
    link.hello()
    reply = encode_reply(ReplyCode.CAPACITY, "2048 samples do not fit")
    board.answer = lambda frame: board.send(FrameType.STOP_REPLY, reply, tag=frame.header.tag)
    with pytest.raises(BoardRefusedError, match="CAPACITY: 2048 samples do not fit"):
        link.stop()


def test_a_board_that_stops_answering_is_noticed(link, board):
    link.hello()
    board.mute = True
    with pytest.raises(DeviceTimeoutError, match="did not answer STATUS in 3 tries"):
        link.status()


def test_frames_of_another_session_mean_a_reboot(link, board):
    link.hello()
    board.session += 1
    with pytest.raises(DeviceLostError, match="has restarted"):
        link.status()


def test_data_that_came_while_waiting_is_not_lost(link, board):
    link.hello()
    board.send(FrameType.BLOCK_READY, b"first")
    board.send(FrameType.BLOCK_READY, b"second")
    link.status()
    assert [frame.payload for frame in link.pump()] == [b"first", b"second"]


def test_a_repeated_frame_is_dropped(link, board):
    link.hello()
    board.send(FrameType.BLOCK_READY, b"once")
    board.sequence -= 1
    board.send(FrameType.BLOCK_READY, b"once")
    link.status()
    assert [frame.payload for frame in link.pump()] == [b"once"]


def test_the_round_trip_brackets_the_devices_clock(link):
    link.hello()
    _, trip = link.status()
    # The fake's ticks are microseconds of the clock we read ourselves.
    assert trip.sent_s - 1e-6 <= trip.ticks / 1e6 <= trip.received_s + 1e-6
