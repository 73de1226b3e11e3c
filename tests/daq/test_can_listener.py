from __future__ import annotations

import can
import pytest

from armodal.daq.can_listener import PythonCanListener, SlcanListener, open_can
from armodal.daq.serial_port import SerialPort
from armodal.protocols.errors import CanError, DeviceTimeoutError, PortError

BITRATE = 500_000


def test_a_listener_has_no_way_to_send():
    for kind in (SlcanListener, PythonCanListener):
        assert not [name for name in dir(kind) if "send" in name or "write" in name]


def test_the_adapter_is_told_to_listen_only_before_anything_is_heard(controller):
    source = open_can(controller.name, BITRATE)
    try:
        assert controller.commands == [b"C", b"S6", b"L"]
        frames = []
        while len(frames) < 3:
            source.collect(1.5)
            for at_s, some in source.take():
                assert at_s == 1.5
                frames += some
        assert len({frame.can_id for frame in frames}) == 3
    finally:
        source.close()


@pytest.mark.parametrize("command", [b"S", b"L"])
def test_an_adapter_that_refuses_is_not_used(controller, command):
    controller.refuse = command
    with pytest.raises(CanError, match="cannot be made to listen only"):
        open_can(f"slcan:{controller.name}", BITRATE)


def test_closing_a_channel_that_was_not_open_may_be_refused(controller):
    controller.refuse = b"C"
    open_can(controller.name, BITRATE).close()


def test_a_device_that_is_no_adapter_is_said_so(board):
    board.mute = True
    with pytest.raises(DeviceTimeoutError, match="is it an slcan adapter"):
        open_can(board.name, BITRATE, adapter_timeout_s=0.1)
    # The port was let go of.
    SerialPort(board.name).close()


def test_python_can_frames_arrive_and_errors_and_fd_frames_do_not():
    with can.Bus(interface="virtual", channel="listener-test") as other:
        source = open_can("virtual:listener-test", BITRATE)
        try:
            other.send(can.Message(arbitration_id=0x201, data=b"\x01\x02", is_extended_id=False))
            other.send(can.Message(arbitration_id=0x18FF0001, data=b"", is_extended_id=True))
            other.send(can.Message(arbitration_id=0x202, is_fd=True, data=bytes(12)))
            other.send(can.Message(is_error_frame=True))
            source.collect(1.5)
            ((at_s, frames),) = source.take()
            assert at_s == 1.5
            assert [(f.can_id, f.extended, f.data) for f in frames] == [
                (0x201, False, b"\x01\x02"),
                (0x18FF0001, True, b""),
            ]
            assert source.fileno() == -1
        finally:
            source.close()


@pytest.mark.parametrize("channel", ["can0", "socketcan:", ":can0", "", "nonsense:can0"])
def test_a_channel_that_names_no_interface_is_refused(channel):
    with pytest.raises(CanError, match="CAN channel"):
        open_can(channel, BITRATE)


def test_a_serial_path_that_is_not_there_is_refused():
    with pytest.raises(PortError, match="there is no such device"):
        open_can("/dev/there-is-no-such-port", BITRATE)
