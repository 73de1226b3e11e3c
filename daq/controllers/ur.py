"""Joint angles of a Universal Robots controller by RTDE over TCP, listened to and never written.

Three requests are sent, which ask for outputs to be told; none of them reaches the robot. The
connection is not kept on this object: only its receiving half is.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator

from armodal.daq.controller import AtAddress, ControllerOption
from armodal.daq.joint_source import MeasuredAngles
from armodal.daq.timed_joints import TimedJoints
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import (
    ArmError,
    ControllerError,
    DeviceLostError,
    DeviceTimeoutError,
)
from armodal.protocols.rtde import (
    JOINTS,
    RtdeKind,
    RtdePackage,
    RtdeParser,
    decode_accepted,
    decode_outputs,
    decode_sample,
    decode_version,
    request_outputs,
    request_start,
    request_version,
)

__all__ = ["OPTION", "RtdeSource", "ur_joints", "ur_source"]

PORT = 30004
RATE_HZ = 125.0  # what every controller of the CB3 and e-Series sends
STALE_AFTER_S = 0.1  # twelve packages
ANSWER_WALL_S = 3.0
MOST_BYTES = 65536


def ur_joints() -> TimedJoints:
    """Angles as a Universal Robots controller tells them, none yet."""
    names = [f"joint {i + 1}" for i in range(JOINTS)]
    return TimedJoints(names, rate_hz=RATE_HZ, stale_after_s=STALE_AFTER_S)


class RtdeSource(MeasuredAngles):
    """A controller that tells its joint angles.

    Parameters
    ----------
    address
        HOST or HOST:PORT.

    Raises
    ------
    ControllerError, DeviceTimeoutError, DeviceLostError
        If it cannot be reached, is no such controller, or does not tell what is wanted.
    """

    def __init__(self, address: str) -> None:
        host, port = _parts(address)
        self.name = f"{host}:{port}"
        self.joints = ur_joints()
        self._parser = RtdeParser()
        self._fetched: list[tuple[float, bytes]] = []
        line = _connect(host, port)
        try:
            self._recipe = self._agree(line)
            line.setblocking(False)
        except BaseException:
            line.close()
            raise
        self._receive, self._close, self._fd = line.recv, line.close, line.fileno()

    @property
    def faults(self) -> int:
        """What came and could not be read."""
        return self.joints.invalid

    def fileno(self) -> int:
        """Return the connection's descriptor."""
        return self._fd

    def collect(self, now_s: float) -> None:
        """Fetch the bytes that have come."""
        try:
            data = self._receive(MOST_BYTES)
        except BlockingIOError:
            return
        except OSError as error:
            raise self._lost(error.strerror or "the line broke") from error
        if not data:
            raise self._lost("it has closed the line")
        self._fetched.append((now_s, data))

    def hear(self) -> None:
        """Read the packages in the bytes fetched."""
        fetched, self._fetched = self._fetched, []
        for at_s, data in fetched:
            for package in self._parser.feed(data):
                if package.kind is RtdeKind.DATA:
                    self.joints.take(decode_sample(package.payload, self._recipe), at_s)

    def silence(self) -> str:
        """Say what is missing."""
        return (
            f"the controller at {self.name} has accepted to tell joint angles and tells none: is "
            "the robot powered, and does another program use RTDE?"
        )

    def close(self) -> None:
        """Hang up; the controller goes on by itself."""
        self._close()

    def _agree(self, line: socket.socket) -> int:
        """Ask for the outputs; return the recipe's number."""
        decode_version(self._ask(line, request_version(), RtdeKind.VERSION))
        recipe = decode_outputs(self._ask(line, request_outputs(RATE_HZ), RtdeKind.OUTPUTS))
        if not decode_accepted(self._ask(line, request_start(), RtdeKind.START)):
            raise ControllerError(
                f"the controller at {self.name} refuses to begin telling; look at its log"
            )
        return recipe

    def _ask(self, line: socket.socket, request: bytes, kind: RtdeKind) -> bytes:
        line.sendall(request)
        for package in self._packages(line):
            if package.kind is kind:
                return package.payload
        raise AssertionError  # the line ends by an error

    def _packages(self, line: socket.socket) -> Iterator[RtdePackage]:
        until_s = time.monotonic() + ANSWER_WALL_S
        while (left_s := until_s - time.monotonic()) > 0.0:
            line.settimeout(left_s)
            try:
                data = line.recv(MOST_BYTES)
            except TimeoutError:
                break
            except OSError as error:
                raise self._lost(error.strerror or "the line broke") from error
            if not data:
                raise self._lost("it has closed the line")
            yield from self._parser.feed(data)
        raise DeviceTimeoutError(
            f"the controller at {self.name} does not answer in {ANSWER_WALL_S:g} s: is it a "
            "Universal Robots controller, and is RTDE allowed in its security settings?"
        )

    def _lost(self, why: str) -> DeviceLostError:
        return DeviceLostError(
            f"the controller at {self.name} is gone ({why}); check it and its network, then resume"
        )


def _parts(address: str) -> tuple[str, int]:
    host, _, port = address.partition(":")
    if not host or (port and not (port.isascii() and port.isdigit() and 0 < int(port) < 65536)):
        raise ControllerError(
            f"wanted a controller's address as HOST or HOST:PORT, got {address!r}; its screen "
            "shows it under Settings, System, Network"
        )
    return host, int(port) if port else PORT


def _connect(host: str, port: int) -> socket.socket:
    try:
        return socket.create_connection((host, port), ANSWER_WALL_S)
    except TimeoutError as error:
        raise DeviceTimeoutError(
            f"nothing answers at {host}:{port}: is the controller on, and this computer on its "
            "network?"
        ) from error
    except ConnectionRefusedError as error:
        raise ControllerError(
            f"{host} is there and nothing listens on port {port}: is it a Universal Robots "
            "controller, and is RTDE allowed in its security settings?"
        ) from error
    except (OSError, UnicodeError) as error:
        raise ControllerError(
            f"{host}:{port} cannot be reached from this computer: check address and network"
        ) from error


def ur_source(address: str, arm: Arm) -> RtdeSource:
    """Connect to a controller, if the arm can be its own."""
    if len(arm.joints) != JOINTS:
        raise ArmError(
            f"arm {arm.name} has {len(arm.joints)} joints, a Universal Robots controller tells "
            f"{JOINTS} angles: give the arm file of this robot"
        )
    return RtdeSource(address)


OPTION = ControllerOption(
    metavar="HOST[:PORT]",
    help="joint angles from a Universal Robots controller (RTDE).",
    controller=lambda given: AtAddress(address=given, source=ur_source),
)
