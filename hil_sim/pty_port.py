"""One end of a serial line: the master of a pseudo-terminal that never blocks."""

from __future__ import annotations

import os
import tty
from contextlib import suppress

__all__ = ["PtyPort"]

READ_SIZE = 4096
# Above this the device stops listening until the host has read what it was told, so that a host
# that asks and never reads cannot make the buffer grow.
MAX_BACKLOG = 64 * 1024


class PtyPort:
    """A pseudo-terminal seen from the device.

    The slave stays open here as well: without it the master reads EIO whenever no host is there.

    Attributes
    ----------
    name : str
        Path of the slave, which the host opens.
    """

    def __init__(self) -> None:
        self._outgoing = bytearray()
        self._open()

    def _open(self) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(self._slave)

    def fileno(self) -> int:
        """Return the descriptor to select on."""
        return self._master

    @property
    def pending(self) -> int:
        """Bytes queued that the line has not taken yet."""
        return len(self._outgoing)

    @property
    def listening(self) -> bool:
        """Whether commands are read at present."""
        return len(self._outgoing) <= MAX_BACKLOG

    def read(self) -> bytes:
        """Return what the host has written, b"" if nothing."""
        if not self.listening:
            return b""
        try:
            return os.read(self._master, READ_SIZE)
        except BlockingIOError:
            return b""

    def queue(self, data: bytes) -> None:
        """Append bytes to be sent; `flush` sends them."""
        self._outgoing += data

    def flush(self) -> bool:
        """Write as much as the line takes; return whether all of it is gone."""
        while self._outgoing:
            try:
                written = os.write(self._master, self._outgoing)
            except BlockingIOError:
                return False
            if written == 0:
                return False
            del self._outgoing[:written]
        return True

    def unplug(self) -> None:
        """Hang up on the host, and lose what is on the way; the line then has another name."""
        self._outgoing.clear()
        self.close()
        self._open()

    def plug(self) -> None:
        """Drop what a host may have said to a line that was not there."""
        with suppress(BlockingIOError):
            while os.read(self._master, READ_SIZE):
                pass

    def close(self) -> None:
        """Close both ends; a second call does nothing."""
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._master = self._slave = -1
