"""A faulty device made of a healthy one: bytes are relayed, and altered on their way.

The healthy device, simulated or real, keeps its own line; the relay opens that, and offers a
pseudo-terminal in its place. So a fault needs to know nothing of what is inside the device.
"""

from __future__ import annotations

import os
import select
import threading
import tty
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from typing import Protocol

from armodal.hil_sim.pty_port import PtyPort
from armodal.protocols.errors import PortError
from armodal.protocols.os_words import os_words

__all__ = ["Alteration", "Relay", "relayed"]

READ_SIZE = 4096
# Above this the relay stops reading, so that a line that nobody reads backs up to the device.
MOST_PENDING = 8192
TICK_S = 0.02


class Alteration(Protocol):
    """What happens to the bytes on their way."""

    def to_host(self, data: bytes) -> bytes:
        """Return what the host gets for bytes of the device; b"" asks for what has been held."""

    def to_device(self, data: bytes) -> bytes:
        """Return what the device gets for bytes of the host."""


class Relay:
    """Device on the one side, pseudo-terminal on the other.

    Parameters
    ----------
    device
        Path of the healthy device's line.

    Raises
    ------
    PortError
        If the device's line cannot be opened.
    """

    def __init__(self, device: str, alteration: Alteration) -> None:
        self._alteration = alteration
        try:
            self._device = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError as error:
            raise PortError(f"cannot open port {device}: {os_words(error)}") from error
        try:
            tty.setraw(self._device)
            self.port = PtyPort()
        except BaseException:
            os.close(self._device)
            raise
        self._to_device = b""

    @property
    def name(self) -> str:
        """Path of the line which the host opens."""
        return self.port.name

    def wait(self) -> None:
        """Sleep until there is something to do, or a little while."""
        readers = [self.port.fileno()]
        if self.port.pending < MOST_PENDING:
            readers.append(self._device)
        writers = [self.port.fileno()] if self.port.pending else []
        writers += [self._device] if self._to_device else []
        select.select(readers, writers, [], TICK_S)

    def step(self) -> bool:
        """Carry bytes both ways; False once the device is gone."""
        try:
            self._to_device += self._alteration.to_device(self.port.read())
            if self._to_device:
                with suppress(BlockingIOError):
                    self._to_device = self._to_device[os.write(self._device, self._to_device) :]
            if self.port.pending < MOST_PENDING:
                self.port.queue(self._alteration.to_host(self._read_device()))
        except OSError:
            return False
        self.port.flush()
        return True

    def close(self) -> None:
        """Close both lines; a second call does nothing."""
        self.port.close()
        if self._device >= 0:
            os.close(self._device)
            self._device = -1

    def _read_device(self) -> bytes:
        try:
            return os.read(self._device, READ_SIZE)
        except BlockingIOError:
            return b""


@contextmanager
def relayed(device: str, alteration: Alteration) -> Iterator[str]:
    """Relay a device's line in a thread of its own while the context lasts.

    Yields
    ------
    str
        Path of the line which the host opens.
    """
    stop = threading.Event()

    def serve(relay: Relay) -> None:
        while not stop.is_set():
            relay.wait()
            if not relay.step():
                return

    with closing(Relay(device, alteration)) as relay:
        thread = threading.Thread(target=serve, args=(relay,), name="relay", daemon=True)
        thread.start()
        try:
            yield relay.name
        finally:
            stop.set()
            thread.join()
