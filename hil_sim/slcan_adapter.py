"""A serial CAN adapter's side of the slcan lines, without its bus."""

from __future__ import annotations

import re

from armodal.protocols.slcan import MAX_LINE, bitrate_command

__all__ = ["SlcanAdapter"]

DONE, REFUSED = b"\r", b"\x07"
_OVERRUN = 0x01  # status bit 0: receive queue full


class SlcanAdapter:
    """Answers commands as Lawicel's manual says.

    Frames of the bus are forwarded only while the channel is open, and only if it was opened with
    the bus's own bit rate.

    Parameters
    ----------
    bitrate
        Bit rate of the bus.

    Attributes
    ----------
    transmissions : int
        Frames the host asked to transmit; a listener asks for none.
    """

    def __init__(self, *, bitrate: int) -> None:
        self._right_rate = bitrate_command(bitrate)[:-1]
        self._rate = b""
        self._open = b""
        self._line = bytearray()
        self._status = 0
        self.transmissions = 0

    @property
    def forwards(self) -> bool:
        """Whether frames of the bus reach the host."""
        return bool(self._open) and self._rate == self._right_rate

    def overrun(self) -> None:
        """A frame found no room."""
        self._status |= _OVERRUN

    def feed(self, data: bytes) -> bytes:
        """Take bytes from the host and return the answers."""
        answers = b""
        for part in re.split(rb"(\r)", data):
            if part != b"\r":
                self._line += part[: MAX_LINE + 1 - len(self._line)]
                continue
            line = bytes(self._line)
            self._line.clear()
            answers += self._answer(line) if len(line) <= MAX_LINE else REFUSED
        return answers

    def _answer(self, line: bytes) -> bytes:
        head = line[:1]
        if not line:
            return DONE
        if head in b"tTrR":
            return self._transmit(head)
        if line == b"V":
            return b"V1013\r"
        if line == b"N":
            return b"NS042\r"
        if line == b"F" and self._open:
            status, self._status = self._status, 0
            return f"F{status:02X}\r".encode()
        return DONE if self._set(line) else REFUSED

    def _set(self, line: bytes) -> bool:
        if line == b"C":
            self._open = b""
        elif self._open:
            return False
        elif re.fullmatch(rb"S[0-8]", line):
            self._rate = line
        elif line in (b"O", b"L") and self._rate:
            self._open = line
        else:
            return line == b"Z0"
        return True

    def _transmit(self, head: bytes) -> bytes:
        self.transmissions += 1
        if self._open != b"O":
            return REFUSED
        return (b"z" if head in b"tr" else b"Z") + DONE
