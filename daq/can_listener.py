"""The controller's bus, listened to and never written.

Serial adapters are opened to listen only by our own slcan reader; every other interface goes
through python-can, of which only the receiving half is kept.
"""

from __future__ import annotations

from typing import Any, Protocol

import can

from armodal.daq.clock import Clock, SystemClock, waits
from armodal.daq.serial_port import BytePort, SerialPort
from armodal.protocols.arm.records import CanMapping
from armodal.protocols.can_database import fd_messages
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError, DeviceLostError, DeviceTimeoutError
from armodal.protocols.slcan import (
    CLOSE,
    STATUS,
    SlcanFault,
    SlcanParser,
    SlcanReply,
    listen_only_commands,
)

__all__ = ["CanSource", "PythonCanListener", "SlcanListener", "check_hears", "open_can"]

ADAPTER_TIMEOUT_S = 3.0  # of the wall clock: the adapter is no part of the laboratory's time
CLOSE_TIMEOUT_S = 0.2  # some adapters are silent when a closed channel is closed
FRAMES_AT_ONCE = 4096

_BUILT_IN = ("socketcan", "udp_multicast", "virtual")  # no bit rate of their own
# Interfaces that hear CAN FD: the system has set both bit rates.
_FD: dict[str, dict[str, Any]] = {
    "socketcan": {"fd": True},
    "udp_multicast": {"fd": True},
    "virtual": {},
}
_SILENT: dict[str, dict[str, Any]] = {
    "cantact": {"monitor": True},
    "kvaser": {"driver_mode": False},
    "nixnet": {"listen_only": True},
    "pcan": {"state": can.BusState.PASSIVE},
    "seeedstudio": {"operation_mode": "silent"},
    "systec": {"state": can.BusState.PASSIVE},
    "vector": {"listen_only": True},
}


class CanSource(Protocol):
    """Where CAN frames come from; there is no way to send one."""

    name: str
    confirmed_silent: bool  # whether it has said that it only listens
    status_flags: int | None  # error flags of a serial adapter, None where it told none
    error_frames: int

    @property
    def faults(self) -> int:
        """What came and was no frame."""

    def fileno(self) -> int:
        """Return the descriptor to wait on, or -1 where the source must be asked."""

    def collect(self, now_s: float) -> None:
        """Fetch what has come by `now_s`; never waits, and leaves the work to `take`."""

    def take(self) -> list[tuple[float, list[CanFrame]]]:
        """Return the frames collected since the last time, with the times they were fetched."""

    def ask_status(self) -> None:
        """Ask the adapter, not the bus, for its error flags, where it has any."""

    def close(self) -> None:
        """Let go of the bus; never raises."""


def open_can(
    channel: str, bitrate: int, *, adapter_timeout_s: float = ADAPTER_TIMEOUT_S
) -> CanSource:
    """Open a bus to listen.

    Parameters
    ----------
    channel
        Path of a serial (slcan) adapter, as ``/dev/ttyACM1`` or ``slcan:/dev/ttyACM1``, or
        ``interface:channel`` of python-can, as ``socketcan:can0``.
    bitrate
        Bit rate of the bus, bit/s.
    adapter_timeout_s
        How long a serial adapter is given to answer a command.

    Raises
    ------
    PortError, CanError, DeviceTimeoutError, DeviceLostError
        If it cannot be opened, or the adapter does not confirm that it only listens.
    """
    interface, colon, rest = channel.partition(":")
    if channel.startswith("/") or interface == "slcan":
        port = SerialPort(channel if channel.startswith("/") else rest)
        try:
            return SlcanListener(port, bitrate, adapter_timeout_s=adapter_timeout_s)
        except BaseException:
            port.close()
            raise
    if not (colon and interface and rest):
        raise CanError(
            "CAN channel: wanted the path of a serial adapter or interface:channel, as "
            f"socketcan:can0, got {channel!r}"
        )
    return PythonCanListener(interface, rest, bitrate)


def check_hears(channel: str, mapping: CanMapping) -> None:
    """Refuse a channel that cannot hear the frames of a mapping.

    Raises
    ------
    CanError
        If a mapped message is longer than a classic frame, and the channel hears no CAN FD; or if
        the mapping is not one.
    """
    long = fd_messages(mapping)
    if long and channel.partition(":")[0] not in _FD:
        raise CanError(
            f"CAN channel {channel}: wanted one that hears CAN FD, since {', '.join(long)} of "
            f"{mapping.database} are longer than 8 bytes; give it as socketcan:can0, set up with "
            "`ip link set can0 type can bitrate ... dbitrate ... fd on listen-only on`"
        )


class SlcanListener:
    """A serial adapter that has confirmed to listen only.

    Raises
    ------
    CanError
        If the adapter refuses a command.
    DeviceTimeoutError
        If it does not answer.

    Attributes
    ----------
    status_flags : int or None
        All error flags the adapter has told of since it was opened; None while it has told
        nothing, as it does only when asked by `ask_status`.
    """

    confirmed_silent = True
    error_frames = 0

    def __init__(
        self,
        port: BytePort,
        bitrate: int,
        clock: Clock | None = None,
        *,
        adapter_timeout_s: float = ADAPTER_TIMEOUT_S,
    ) -> None:
        self.name = port.name
        self._adapter_timeout_s = adapter_timeout_s
        self._clock = clock or SystemClock()
        self.status_flags: int | None = None
        self._port = port
        self._parser = SlcanParser()
        self._fetched: list[tuple[float, bytes]] = []
        for command in listen_only_commands(bitrate):
            self._command(command)
        # A line was perhaps under way when the port was opened: nobody listened yet.
        self._faults_before = self._parser.faults

    @property
    def faults(self) -> int:
        """Lines that were no frame, since the adapter confirmed to listen."""
        return self._parser.faults - self._faults_before

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._port.fileno()

    def collect(self, now_s: float) -> None:
        """Fetch the bytes that have come."""
        self._fetched.append((now_s, self._port.read()))

    def take(self) -> list[tuple[float, list[CanFrame]]]:
        """Return the frames in the bytes fetched."""
        fetched, self._fetched = self._fetched, []
        return [(at_s, self._frames(data)) for at_s, data in fetched]

    def ask_status(self) -> None:
        """Ask the adapter, not the bus, for its error flags; `take` finds the answer."""
        self._port.write(STATUS)

    def close(self) -> None:
        """Close the line; the adapter is left listening, which disturbs nobody."""
        self._port.close()

    def _wall_s(self) -> float:
        return self._clock.wall_s(self._clock.now_s())

    def _frames(self, data: bytes) -> list[CanFrame]:
        frames = []
        for item in self._parser.feed(data):
            if isinstance(item, CanFrame):
                frames.append(item)
            elif isinstance(item, SlcanReply) and item.text.startswith("F"):
                self.status_flags = (self.status_flags or 0) | int(item.text[1:], 16)
        return frames

    def _command(self, command: bytes) -> None:
        self._port.write(command)
        optional = command == CLOSE
        n_faults = 0
        until = self._wall_s() + (CLOSE_TIMEOUT_S if optional else self._adapter_timeout_s)
        for left in waits(until, self._wall_s):
            if not self._clock.wait([self._port.fileno()], left):
                break
            for item in self._parser.feed(self._port.read()):
                n_faults += isinstance(item, SlcanFault)
                if isinstance(item, SlcanReply):
                    if item.ok or optional:
                        return
                    raise CanError(
                        f"the CAN adapter on {self.name} refused {command[:-1].decode()!r}: it "
                        "cannot be made to listen only at this bit rate, so it is not used"
                    )
        if not optional:
            said = f"{n_faults} lines that are not slcan" if n_faults else "nothing"
            raise DeviceTimeoutError(
                f"the CAN adapter on {self.name} answered {said} to {command[:-1].decode()!r}; "
                "is it an slcan adapter, and the right port?"
            )


class PythonCanListener:
    """Any interface of python-can, of which only receiving is kept.

    Attributes
    ----------
    error_frames : int
        Error frames that the interface has reported.
    """

    confirmed_silent = False
    status_flags: int | None = None
    faults = 0

    def __init__(self, interface: str, channel: str, bitrate: int) -> None:
        self.name = f"{interface}:{channel}"
        options = _SILENT.get(interface, {}) | _FD.get(interface, {})
        if interface not in _BUILT_IN:
            options["bitrate"] = bitrate
        try:
            bus = can.Bus(interface=interface, channel=channel, **options)
        except (can.CanError, OSError, ValueError, TypeError, ImportError) as error:
            raise CanError(
                f"cannot open CAN channel {self.name}: {error}; does the interface exist, and is "
                "it up?"
            ) from error
        # The bus object lives on behind `recv`; not even by way of it can a frame be sent.
        for way_out in ("send", "send_periodic"):
            setattr(bus, way_out, _never_send)
        self.error_frames = 0
        self._fetched: list[tuple[float, list[CanFrame]]] = []
        self._receive = bus.recv
        self._shutdown = bus.shutdown
        try:
            self._fd = int(bus.fileno())
        except (NotImplementedError, can.CanError, OSError):  # an interface without a descriptor
            self._fd = -1

    def fileno(self) -> int:
        """Return the descriptor to wait on, or -1 where the interface must be asked."""
        return self._fd

    def collect(self, now_s: float) -> None:
        """Fetch the frames that have come."""
        self._fetched.append((now_s, self._read()))

    def take(self) -> list[tuple[float, list[CanFrame]]]:
        """Return the frames fetched."""
        fetched, self._fetched = self._fetched, []
        return fetched

    def ask_status(self) -> None:
        """Do nothing: error frames tell of errors here."""

    def close(self) -> None:
        """Let go of the bus."""
        try:
            self._shutdown()
        except (can.CanError, OSError):
            return

    def _read(self) -> list[CanFrame]:
        frames: list[CanFrame] = []
        try:
            for _ in range(FRAMES_AT_ONCE):
                message = self._receive(timeout=0)
                if message is None:
                    break
                self.error_frames += message.is_error_frame
                if message.is_error_frame:
                    continue
                frames.append(
                    CanFrame(
                        can_id=message.arbitration_id,
                        extended=message.is_extended_id,
                        data=bytes(message.data),
                        remote=message.is_remote_frame,
                        fd=message.is_fd,
                    )
                )
        except (can.CanError, OSError) as error:
            raise DeviceLostError(
                f"the CAN channel {self.name} is gone ({error}); check it, then resume"
            ) from error
        return frames


def _never_send(*_: object, **__: object) -> None:
    raise CanError("armodal only listens to the CAN bus, and sends nothing on it")
