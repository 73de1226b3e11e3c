"""The robot's bus is listened to and nothing else, over a whole session, by every interface."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import can
import pytest
from support.fake_session import SCALE, whole_session

from armodal.daq.can_listener import open_can
from armodal.daq.events import Finished
from armodal.protocols.can_database import CanEncoder
from armodal.protocols.errors import CanError

FRAME = struct.Struct("=IB3x8s")  # struct can_frame of Linux
# All that python-can knows, without those that are tried by themselves below.
OTHER_INTERFACES = sorted(set(can.VALID_INTERFACES) - {"slcan", "socketcan", "virtual"})
# What makes python-can 4.6 open an interface silent; the others know no such option.
SILENT: dict[str, dict[str, Any]] = {
    "cantact": {"monitor": True},
    "kvaser": {"driver_mode": False},
    "nixnet": {"listen_only": True},
    "pcan": {"state": can.BusState.PASSIVE},
    "seeedstudio": {"operation_mode": "silent"},
    "systec": {"state": can.BusState.PASSIVE},
    "vector": {"listen_only": True},
}


class Robot:
    """Sends a controller's cycle 125 times a lab second, by whatever way it is given."""

    def __init__(self, lab: Any, send: Callable[[int, bytes], None]) -> None:
        self._encoder = CanEncoder(lab.arm.can)
        self._names = [joint.name for joint in lab.arm.joints]
        self._lab = lab
        self._send = send
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._thread.join(5.0)

    def _run(self) -> None:
        counter = 0
        fake = self._lab.controller
        while not self._stop.wait(0.008 / SCALE):
            counter += 1
            angles = dict(zip(self._names, fake.joints_rad.tolist(), strict=True))
            for frame in self._encoder.encode(
                angles, drive_state=fake.drive_state, counter=counter
            ):
                self._send(frame.can_id, frame.data)


class Overheard(can.BusABC):
    """An interface of python-can whose driver is not here: what is asked of it is noted."""

    def __init__(self, channel: Any, can_filters: Any = None, **options: Any) -> None:
        self.options = options
        self.asked: list[str] = []
        self._frames: list[can.Message] = []
        super().__init__(channel=channel, can_filters=can_filters)

    def put(self, can_id: int, data: bytes) -> None:
        self._frames.append(can.Message(arbitration_id=can_id, is_extended_id=False, data=data))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        return (self._frames.pop(0) if self._frames else None), False

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self.asked.append("send")

    def flush_tx_buffer(self) -> None:
        self.asked.append("flush_tx_buffer")

    @property
    def state(self) -> can.BusState:
        return can.BusState.PASSIVE

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        self.asked.append(f"state {new_state}")


@pytest.fixture
def robots() -> Iterator[list[Robot]]:
    robots: list[Robot] = []
    yield robots
    for robot in robots:
        robot.close()


def session_over(lab: Any, fakes: Any, channel: str) -> None:
    end, code = whole_session(lab, fakes["record"](), can_channel=channel)
    assert isinstance(end, Finished), end
    assert code == 0
    assert end.complete
    assert end.accepted == 4


def test_an_slcan_adapter_gets_three_commands_and_no_other_byte(lab, fakes):
    said: list[bytes] = []
    answered = lab.controller.received
    lab.controller.received = lambda data: (said.append(data), answered(data))[1]
    session_over(lab, fakes, f"slcan:{lab.controller.name}")
    assert b"".join(said) == b"C\rS6\rL\r"


def test_a_controller_on_a_python_can_bus_receives_no_frame(lab, fakes, robots):
    with can.Bus(interface="virtual", channel="armodal-read-only") as controller:
        robots.append(
            Robot(
                lab,
                lambda can_id, data: controller.send(
                    can.Message(arbitration_id=can_id, is_extended_id=False, data=data)
                ),
            )
        )
        session_over(lab, fakes, "virtual:armodal-read-only")
        robots[0].close()
        assert controller.recv(0.0) is None


def test_a_socketcan_interface_is_given_nothing_to_send(lab, fakes, robots, monkeypatch):
    # python-can's own class, on a datagram socket in place of a raw CAN socket.
    ours, theirs = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    with ours, theirs:
        for end in (ours, theirs):
            end.bind(("127.0.0.1", 0))
        ours.connect(theirs.getsockname())
        theirs.connect(ours.getsockname())
        where = "can.interfaces.socketcan.socketcan"
        monkeypatch.setattr(f"{where}.create_socket", lambda: theirs)
        monkeypatch.setattr(f"{where}.bind_socket", lambda sock, channel: None)

        def send(can_id: int, data: bytes) -> None:
            with suppress(ConnectionRefusedError):  # the listener has closed its end
                ours.send(FRAME.pack(can_id, len(data), data))

        robots.append(Robot(lab, send))
        session_over(lab, fakes, "socketcan:can0")
        robots[0].close()
        ours.setblocking(False)
        with pytest.raises((BlockingIOError, ConnectionRefusedError)):
            ours.recv(64)


@pytest.fixture
def opened(monkeypatch) -> list[Overheard]:
    """Interfaces as they are opened, in place of drivers."""
    opened: list[Overheard] = []

    def bus(interface: str, channel: str, **options: Any) -> Overheard:
        opened.append(Overheard(channel, **options))
        return opened[-1]

    monkeypatch.setattr(can, "Bus", bus)
    return opened


@pytest.mark.parametrize("interface", OTHER_INTERFACES)
def test_another_interface_is_opened_silent_and_asked_for_nothing(opened, interface):
    source = open_can(f"{interface}:0", 500_000)
    opened[0].put(0x123, b"\x01")
    source.collect(0.0)
    source.ask_status()
    [(_, frames)] = source.take()
    source.close()
    assert [(frame.can_id, frame.data) for frame in frames] == [(0x123, b"\x01")]
    # Longer frames are heard where the interface may bring them, which asks for nothing.
    hears = {"fd": True} if interface == "udp_multicast" else {"bitrate": 500_000}
    assert opened[0].options == SILENT.get(interface, {}) | hears
    assert opened[0].asked == []


# What differs from one to another is how it is opened.
@pytest.mark.parametrize(
    "interface",
    [
        name if name in {"pcan", "udp_multicast"} else pytest.param(name, marks=pytest.mark.long)
        for name in OTHER_INTERFACES
    ],
)
def test_another_interface_is_asked_for_nothing_over_a_session(
    lab, fakes, robots, opened, monkeypatch, interface
):
    without_robot = can.Bus

    def bus(**options: Any) -> Overheard:
        made = without_robot(**options)
        robots.append(Robot(lab, made.put))
        return made

    monkeypatch.setattr(can, "Bus", bus)
    session_over(lab, fakes, f"{interface}:0")
    assert opened[0].asked == []


def test_even_the_bus_behind_the_listener_refuses_to_send(monkeypatch):
    opened: list[can.BusABC] = []
    own = can.Bus

    def bus(**options: Any) -> can.BusABC:
        opened.append(own(**options))
        return opened[0]

    monkeypatch.setattr(can, "Bus", bus)
    source = open_can("virtual:armodal-refuses", 500_000)
    try:
        with pytest.raises(CanError, match="only listens"):
            opened[0].send(can.Message(arbitration_id=1))
        with pytest.raises(CanError, match="only listens"):
            opened[0].send_periodic(can.Message(arbitration_id=1), 0.1)
    finally:
        source.close()
