from __future__ import annotations

from dataclasses import replace

import can
import pytest

from armodal.daq.can_listener import PythonCanListener, SlcanListener, check_hears, open_can
from armodal.daq.serial_port import SerialPort
from armodal.protocols.arm.files import load_arm
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


def test_python_can_frames_arrive_can_fd_too_and_errors_do_not():
    with can.Bus(interface="virtual", channel="listener-test") as other:
        source = open_can("virtual:listener-test", BITRATE)
        try:
            other.send(can.Message(arbitration_id=0x201, data=b"\x01\x02", is_extended_id=False))
            other.send(can.Message(arbitration_id=0x18FF0001, data=b"", is_extended_id=True))
            other.send(
                can.Message(arbitration_id=0x202, is_extended_id=False, is_fd=True, data=bytes(12))
            )
            other.send(can.Message(is_error_frame=True))
            source.collect(1.5)
            ((at_s, frames),) = source.take()
            assert at_s == 1.5
            assert [(f.can_id, f.extended, f.data, f.fd) for f in frames] == [
                (0x201, False, b"\x01\x02", False),
                (0x18FF0001, True, b"", False),
                (0x202, False, bytes(12), True),
            ]
            assert source.fileno() == -1
        finally:
            source.close()


def test_a_mapping_of_can_fd_is_refused_on_a_channel_that_cannot_hear_it():
    mapping = load_arm("rv4frl").can
    long = mapping.database_text.replace("JOINTS_1_2: 8", "JOINTS_1_2: 12")
    assert long != mapping.database_text
    long = replace(mapping, database_text=long)
    for channel in ("/dev/ttyACM0", "slcan:/dev/ttyACM0", "pcan:PCAN_USBBUS1"):
        check_hears(channel, mapping)
        with pytest.raises(CanError, match=r"hears CAN FD, since JOINTS_1_2 of .* longer than 8"):
            check_hears(channel, long)
    check_hears("socketcan:can0", long)


@pytest.mark.parametrize("channel", ["can0", "socketcan:", ":can0", "", "nonsense:can0"])
def test_a_channel_that_names_no_interface_is_refused(channel):
    with pytest.raises(CanError, match="CAN channel"):
        open_can(channel, BITRATE)


def test_a_serial_path_that_is_not_there_is_refused():
    with pytest.raises(PortError, match="there is no such device"):
        open_can("/dev/there-is-no-such-port", BITRATE)
