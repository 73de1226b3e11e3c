"""A raw serial line: opened and configured by pyserial, read and written on its descriptor.

`select` and `os.read` on the descriptor cost less than half of what pyserial's own reads cost,
and an unplugged adapter shows itself in one place only, as `DeviceLostError`.
"""

from __future__ import annotations

import errno
import os
import select
from contextlib import suppress
from typing import Protocol

import serial

from armodal.daq.ports import find_ports
from armodal.daq.session_lock import lock_port
from armodal.protocols.errors import DeviceLostError, DeviceTimeoutError, PortError

__all__ = ["BytePort", "SerialPort"]

LARGEST_READ = 65536
TERMINAL_READ = 4095  # a terminal returns no more at once, however much there is
WRITE_TIMEOUT_S = 2.0


class BytePort(Protocol):
    """What a link needs of a line."""

    name: str

    def fileno(self) -> int:
        """Return the descriptor to wait on."""

    def read(self) -> bytes:
        """Return what has arrived, perhaps nothing; never waits."""

    def write(self, data: bytes) -> None:
        """Send all of `data`."""

    def close(self) -> None:
        """Close the line; never raises."""


class SerialPort:
    """One serial device or pseudo-terminal, held exclusively.

    Parameters
    ----------
    name
        Path of the device, as in ``/dev/ttyACM0``.
    baud
        Bit rate; without meaning for USB lines and pseudo-terminals.

    Raises
    ------
    PortError
        If the port is not there, is no serial line, is not allowed, or is in use.
    """

    def __init__(self, name: str, *, baud: int = 115200) -> None:
        self.name = name
        self._lock = lock_port(name)
        try:
            self._serial = serial.Serial(name, baudrate=baud, timeout=0, exclusive=True)
        except (OSError, ValueError) as error:
            self._lock.release()
            raise _port_error(name, error) from error
        self._fd: int = self._serial.fileno()

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._fd

    def read(self) -> bytes:
        """Return what has arrived, at most 64 KiB, perhaps nothing; never waits.

        Raises
        ------
        DeviceLostError
            If the device is gone.
        """
        parts: list[bytes] = []
        room = LARGEST_READ
        while room > 0:
            try:
                part = os.read(self._fd, TERMINAL_READ + 1)
            except BlockingIOError:
                break
            except OSError as error:
                if parts:
                    break  # what came before is handed on; the next call finds the device gone
                raise self._lost(error) from error
            if not part:
                if not parts:
                    parts.append(self._read_unless_hung_up())
                break
            parts.append(part)
            room -= len(part)
            if len(part) < TERMINAL_READ:
                break  # a short read has emptied the line
        return b"".join(parts)

    def write(self, data: bytes) -> None:
        """Send all of `data`.

        Raises
        ------
        DeviceLostError
            If the device is gone.
        DeviceTimeoutError
            If the device takes nothing for two seconds.
        """
        rest = memoryview(data)
        while rest:
            try:
                rest = rest[os.write(self._fd, rest) :]
            except BlockingIOError:
                if not select.select([], [self._fd], [], WRITE_TIMEOUT_S)[1]:
                    raise DeviceTimeoutError(
                        f"the device on {self.name} took no bytes for {WRITE_TIMEOUT_S:g} s; "
                        "is it switched on and the right port?"
                    ) from None
            except OSError as error:
                raise self._lost(error) from error

    def close(self) -> None:
        """Close the line; an unplugged adapter that refuses even that is let go."""
        with suppress(OSError):
            self._serial.close()
        self._lock.release()

    def _read_unless_hung_up(self) -> bytes:
        # A terminal that is readable and yet gives nothing has been hung up.
        if not select.select([self._fd], [], [], 0)[0]:
            return b""
        try:
            data = os.read(self._fd, TERMINAL_READ + 1)
        except OSError as error:
            raise self._lost(error) from error
        if not data:
            raise self._lost(None)
        return data

    def _lost(self, error: OSError | None) -> DeviceLostError:
        detail = f" ({error.strerror})" if error is not None and error.strerror else ""
        return DeviceLostError(
            f"the device on {self.name} is gone{detail}; check cable and power, then resume"
        )


def _there() -> str:
    """Which ports there are: plugged in again, a device often has another name."""
    ports = ", ".join(f"{port.path} ({port.description})" for port in find_ports())
    return f"There are {ports}" if ports else "No serial device is plugged in"


def _port_error(name: str, error: Exception) -> PortError:
    """Say in one sentence why the port cannot be used."""
    code = getattr(error, "errno", None)
    cause: BaseException | None = error
    while code is None and cause is not None:
        cause = cause.__cause__ or cause.__context__
        code = getattr(cause, "errno", None)
    text = str(error)
    if "lock" in text or code in {errno.EBUSY, errno.EAGAIN}:
        reason = "it is in use by another program; close that one first"
    elif code in {errno.ENOENT, errno.ENXIO, errno.ENODEV}:
        reason = f"there is no such device; is it plugged in, and is this its name? {_there()}"
    elif code in {errno.EACCES, errno.EPERM}:
        reason = "permission denied; on Linux add yourself to the group of the device (dialout)"
    elif code in {errno.EISDIR, errno.ENOTTY, errno.EINVAL} or "configure port" in text:
        reason = "it is not a serial line"
    else:
        reason = text
    return PortError(f"cannot open port {name}: {reason}")
