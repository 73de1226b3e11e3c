from __future__ import annotations

import os
import pty
import tty
from collections.abc import Iterator

import pytest

from armodal.daq.serial_port import SerialPort
from armodal.protocols.errors import DeviceLostError, PortError


class Pair:
    def __init__(self) -> None:
        self.master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.name = os.ttyname(self._slave)

    def unplug(self) -> None:
        if self.master >= 0:
            os.close(self._slave)
            os.close(self.master)
            self.master = -1


@pytest.fixture
def pair() -> Iterator[Pair]:
    pair = Pair()
    yield pair
    pair.unplug()


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("/dev/there-is-no-such-port", "there is no such device"),
        ("/dev/null", "it is not a serial line"),
        (os.path.sep, "it is not a serial line"),
        (__file__, "it is not a serial line"),
    ],
)
def test_a_wrong_port_is_refused_in_one_sentence(name, reason):
    with pytest.raises(PortError, match=reason) as caught:
        SerialPort(name)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_port_in_use_is_refused(pair):
    port = SerialPort(pair.name)
    try:
        with pytest.raises(PortError, match=f"in use by another session, .* {os.getpid()} "):
            SerialPort(pair.name)
    finally:
        port.close()


def test_bytes_pass_unchanged_both_ways(pair):
    everything = bytes(range(256))
    port = SerialPort(pair.name)
    try:
        os.write(pair.master, everything)
        assert port.read() == everything
        assert port.read() == b""
        port.write(everything)
        assert os.read(pair.master, 4096) == everything
    finally:
        port.close()


def test_more_than_the_terminal_hands_out_at_once_is_read_in_one_go(pair):
    port = SerialPort(pair.name)
    try:
        data = os.urandom(8000)  # a read of a pseudo-terminal returns at most 4095
        os.write(pair.master, data)
        got = b""
        while len(got) < len(data):
            got += port.read()
        assert got == data
    finally:
        port.close()


def test_an_unplugged_device_is_lost_for_read_and_write_and_may_be_closed_twice(pair):
    port = SerialPort(pair.name)
    pair.unplug()
    with pytest.raises(DeviceLostError, match="is gone"):
        port.read()
    with pytest.raises(DeviceLostError, match="is gone"):
        port.write(b"x")
    port.close()
    port.close()
