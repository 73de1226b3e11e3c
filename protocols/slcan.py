r"""The slcan line protocol of serial CAN adapters (Lawicel), as a listener needs it.

A line ends with CR (0x0D); a lone CR is "done", BEL (0x07) is "refused". Frames::

    t iii  l dd*   data frame, 11-bit identifier     T iiiiiiii l dd*   29-bit identifier
    r iii  l       remote frame, 11-bit identifier   R iiiiiiii l       29-bit identifier

`l` is the number of data bytes, 0 to 8, and the data must agree with it. Timestamps (`Z1`) are
never switched on. The parser keeps at most one line, takes any byte, and says of every line it
could not read what was wrong with it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError

__all__ = [
    "CLOSE",
    "MAX_LINE",
    "STATUS",
    "CanFrame",
    "SlcanFault",
    "SlcanParser",
    "SlcanReply",
    "bitrate_command",
    "encode_slcan",
    "listen_only_commands",
]

CLOSE = b"C\r"
LISTEN_ONLY = b"L\r"  # opens the channel without acknowledging or sending anything
STATUS = b"F\r"  # reads and clears the adapter's error flags

MAX_LINE = 32  # the longest frame line, T with 8 bytes and a timestamp, has 30 characters

_BITRATES = {
    10_000: b"S0\r",
    20_000: b"S1\r",
    50_000: b"S2\r",
    100_000: b"S3\r",
    125_000: b"S4\r",
    250_000: b"S5\r",
    500_000: b"S6\r",
    800_000: b"S7\r",
    1_000_000: b"S8\r",
}
_BEL = 0x07
_SEPARATORS = re.compile(rb"[\r\x07]")
_HEX = re.compile(rb"[0-9A-Fa-f]*")
_REPLY = re.compile(rb"[zZ]|[VvN][0-9A-Za-z]{1,16}|F[0-9A-Fa-f]{2}")
_MAX_ID = {False: 0x7FF, True: 0x1FFF_FFFF}


@dataclass(frozen=True, slots=True, kw_only=True)
class SlcanReply:
    """The adapter's answer to a command: done or refused, and the text it gave."""

    ok: bool
    text: str  # "" for a lone CR or BEL, else as "V1013", "F00"


@dataclass(frozen=True, slots=True, kw_only=True)
class SlcanFault:
    """A line that is no frame and no reply; later lines are not affected."""

    reason: str  # too-long, not-ascii, unknown, truncated, not-hex, identifier, length
    line: bytes  # its beginning, at most MAX_LINE bytes


class SlcanParser:
    """Turn the adapter's bytes into frames, replies and faults."""

    def __init__(self) -> None:
        self._line = bytearray()
        self._too_long = False
        self.frames = 0
        self.faults = 0

    def feed(self, data: bytes) -> list[CanFrame | SlcanReply | SlcanFault]:
        """Take bytes as they come and return what became complete, in order."""
        found: list[CanFrame | SlcanReply | SlcanFault] = []
        start = 0
        for separator in _SEPARATORS.finditer(data):
            self._append(data[start : separator.start()])
            found += self._end_line(bell=data[separator.start()] == _BEL)
            start = separator.end()
        self._append(data[start:])
        return found

    def _append(self, part: bytes) -> None:
        room = MAX_LINE - len(self._line)
        self._line += part[:room]
        self._too_long = self._too_long or len(part) > room

    def _end_line(self, *, bell: bool) -> list[CanFrame | SlcanReply | SlcanFault]:
        # Some adapters send CR LF: the LF then stands in front of the next line.
        line = bytes(self._line).lstrip(b"\n")
        too_long, self._too_long = self._too_long, False
        self._line.clear()
        found: list[CanFrame | SlcanReply | SlcanFault] = []
        if too_long:
            found.append(SlcanFault(reason="too-long", line=line))
        elif not bell:
            found.append(self._parse(line))
        elif line:
            found.append(SlcanFault(reason="truncated", line=line))
        if found:
            self.frames += isinstance(found[-1], CanFrame)
            self.faults += isinstance(found[-1], SlcanFault)
        if bell:
            found.append(SlcanReply(ok=False, text=""))
        return found

    def _parse(self, line: bytes) -> CanFrame | SlcanReply | SlcanFault:
        if not line:
            return SlcanReply(ok=True, text="")
        if not line.isascii():
            return SlcanFault(reason="not-ascii", line=line)
        if line[:1] in b"tTrR":
            return self._parse_frame(line)
        if _REPLY.fullmatch(line):
            return SlcanReply(ok=True, text=line.decode("ascii"))
        return SlcanFault(reason="unknown", line=line)

    def _parse_frame(self, line: bytes) -> CanFrame | SlcanFault:
        extended, remote = line[:1] in b"TR", line[:1] in b"rR"
        id_end = 9 if extended else 4
        if len(line) <= id_end:
            return SlcanFault(reason="truncated", line=line)
        if not _HEX.fullmatch(line, 1):
            return SlcanFault(reason="not-hex", line=line)
        can_id, length = int(line[1:id_end], 16), int(line[id_end : id_end + 1], 16)
        if can_id > _MAX_ID[extended]:
            return SlcanFault(reason="identifier", line=line)
        digits = 0 if remote else 2 * length
        if length > 8 or len(line) != id_end + 1 + digits:
            return SlcanFault(reason="length", line=line)
        payload = b"" if remote else bytes.fromhex(line[id_end + 1 :].decode("ascii"))
        return CanFrame(can_id=can_id, extended=extended, data=payload, remote=remote)


def encode_slcan(can_id: int, data: bytes, *, extended: bool = False) -> bytes:
    r"""Return the line of one data frame; for simulated controllers, since we never write.

    Raises
    ------
    CanError
        If the identifier or the length does not fit a classic frame.

    >>> encode_slcan(0x301, bytes([1, 0xAB]))
    b't301201AB\r'
    """
    if not 0 <= can_id <= _MAX_ID[extended]:
        raise CanError(f"wanted a CAN identifier from 0 to 0x{_MAX_ID[extended]:x}, got {can_id}")
    if len(data) > 8:
        raise CanError(f"wanted at most 8 data bytes in a classic CAN frame, got {len(data)}")
    head = f"T{can_id:08X}" if extended else f"t{can_id:03X}"
    return f"{head}{len(data)}{data.hex().upper()}\r".encode("ascii")


def bitrate_command(bitrate: int) -> bytes:
    """Return the `S` command of a bit rate in bit/s, or raise CanError with the known rates."""
    if bitrate not in _BITRATES:
        known = ", ".join(str(rate) for rate in _BITRATES)
        raise CanError(f"wanted a bit rate that slcan knows ({known}), got {bitrate}")
    return _BITRATES[bitrate]


def listen_only_commands(bitrate: int) -> tuple[bytes, bytes, bytes]:
    """Return the commands that open the channel to listen only, to be sent one by one.

    The first, closing a channel left open, may be refused; the refusal of another must stop the
    session, since an adapter that does not know `L` would acknowledge frames on the bus.
    """
    return CLOSE, bitrate_command(bitrate), LISTEN_ONLY
