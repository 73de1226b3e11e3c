"""Universal Robots' RTDE as far as it is listened to: packages from bytes, and three requests.

A package is its length with this header (u16, big endian), its type (a letter), and a payload.
Protocol version 2 of the "Real-Time Data Exchange (RTDE) Guide" of Universal Robots. There is no
request here that writes to the controller: no input recipe ('I'), no data package ('U').
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from armodal.protocols.errors import ControllerError
from armodal.protocols.joint_sample import JointSample

__all__ = [
    "JOINTS",
    "OUTPUTS",
    "RtdeKind",
    "RtdePackage",
    "RtdeParser",
    "decode_accepted",
    "decode_outputs",
    "decode_sample",
    "decode_version",
    "request_outputs",
    "request_start",
    "request_version",
]

VERSION = 2
JOINTS = 6
# What is asked for, with the type that the guide gives it.
OUTPUTS = {
    "timestamp": "DOUBLE",  # s since the controller was started
    "actual_q": "VECTOR6D",  # rad
    "robot_mode": "INT32",
    "robot_status_bits": "UINT32",
}
IDLE, RUNNING = 5, 7  # robot modes: powered with brakes on, and held by the drives
TEACH_BUTTON = 1 << 2  # of the status bits: the arm is led by hand

_HEADER = struct.Struct(">HB")
_SAMPLE = struct.Struct(">Bd6diI")


class RtdeKind(Enum):
    """Types of packages that are sent or understood."""

    VERSION = ord("V")
    OUTPUTS = ord("O")
    START = ord("S")
    DATA = ord("U")


@dataclass(frozen=True, slots=True, kw_only=True)
class RtdePackage:
    """One package of the controller; `kind` is None where it is of no type known here."""

    kind: RtdeKind | None
    payload: bytes


class RtdeParser:
    """Cuts a stream of bytes into packages."""

    def __init__(self) -> None:
        self._data = b""

    def feed(self, data: bytes) -> Iterator[RtdePackage]:
        """Yield the packages that are whole by now.

        Raises
        ------
        ControllerError
            If a length is none: the stream is not RTDE, and nothing behind it can be read.
        """
        self._data += data
        while len(self._data) >= _HEADER.size:
            size, kind = _HEADER.unpack_from(self._data)
            if size < _HEADER.size:
                raise ControllerError(
                    f"wanted packages of RTDE, got one of {size} bytes: is this the controller's "
                    "port 30004?"
                )
            if len(self._data) < size:
                return
            payload, self._data = self._data[_HEADER.size : size], self._data[size:]
            known = kind in {member.value for member in RtdeKind}
            yield RtdePackage(kind=RtdeKind(kind) if known else None, payload=payload)


def request_version() -> bytes:
    """Ask for protocol version 2."""
    return _request(RtdeKind.VERSION, struct.pack(">H", VERSION))


def request_outputs(rate_hz: float) -> bytes:
    """Ask to be sent `OUTPUTS`, so often."""
    names = ",".join(OUTPUTS).encode()
    return _request(RtdeKind.OUTPUTS, struct.pack(">d", rate_hz) + names)


def request_start() -> bytes:
    """Ask for the data packages to begin."""
    return _request(RtdeKind.START)


def decode_version(payload: bytes) -> None:
    """Read the answer to `request_version`; ControllerError where it is refused."""
    if not decode_accepted(payload):
        raise ControllerError(
            "the controller refuses RTDE protocol version 2: its software is too old, update it"
        )


def decode_outputs(payload: bytes) -> int:
    """Return the recipe's number; ControllerError where an output cannot be had."""
    types = payload[1:].decode("ascii", errors="replace").split(",")
    wanted = list(OUTPUTS.values())
    if len(payload) < 1 or len(types) != len(wanted):
        raise ControllerError(
            f"wanted a type for each of {len(wanted)} outputs, got {len(types)}; is this a "
            "Universal Robots controller?"
        )
    wrong = [
        f"{name} {got} in place of {want}"
        for (name, want), got in zip(OUTPUTS.items(), types, strict=True)
        if got != want
    ]
    if wrong:
        raise ControllerError(
            f"the controller's outputs are not those wanted: {', '.join(wrong)}; its software is "
            "too old, or it is no Universal Robots controller"
        )
    return payload[0]


def decode_accepted(payload: bytes) -> bool:
    """Return whether a request was accepted."""
    if len(payload) != 1:
        raise ControllerError(f"wanted an answer of 1 byte, got {len(payload)}: is this RTDE?")
    return payload[0] == 1


def decode_sample(payload: bytes, recipe: int) -> JointSample | None:
    """Return what a data package of our recipe tells; None where it cannot be read."""
    if len(payload) != _SAMPLE.size:
        return None
    number, timestamp_s, *joints_rad, mode, status = _SAMPLE.unpack(payload)
    if number != recipe or not all(map(math.isfinite, (timestamp_s, *joints_rad))):
        return None
    return JointSample(
        timestamp_s=timestamp_s,
        joints_rad=tuple(joints_rad),
        drive_state=mode,
        held=mode == IDLE or (mode == RUNNING and not status & TEACH_BUTTON),
    )


def _request(kind: RtdeKind, payload: bytes = b"") -> bytes:
    return _HEADER.pack(_HEADER.size + len(payload), kind.value) + payload
