"""Framing of the journal: magic, records with length, kind and CRC-32, and the scan back.

The bytes are specified in `docs/journal.md`. Nothing here knows what a payload means.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal_bytes import (
    MAX_JOURNAL,
    PIECE,
    InMemory,
    JournalBytes,
    pieces,
)

__all__ = [
    "JOURNAL_VERSION",
    "MAGIC",
    "MAX_JOURNAL",
    "MAX_PAYLOAD",
    "MAX_RECORDS",
    "RECORD_OVERHEAD",
    "Record",
    "RecordKind",
    "Scan",
    "Search",
    "check_magic",
    "encode_record",
    "record_at",
    "scan",
]

JOURNAL_VERSION = 1
MAGIC = b"\x89AMJ\r\n\x1a" + bytes([JOURNAL_VERSION])

MAX_PAYLOAD = 64 * 2**20  # bytes: a hit of 16 million samples
MAX_RECORDS = 200_000

SYNC = 0x4A52  # constant in every record head, so that records beyond damage can be found
_HEAD = struct.Struct("<IHH")
_CRC = struct.Struct("<I")
RECORD_OVERHEAD = _HEAD.size + _CRC.size
_SYNC_BYTES = struct.pack("<H", SYNC)
_SYNC_OFFSET = 6
# The search behind damage takes at most so many bytes of work for each byte searched: more is
# wanted only where somebody made heads of records that are none.
_SEARCH_FACTOR = 16
_PLACE_COST = 1000  # bytes of work: trying one place takes as long as summing so many


class RecordKind(IntEnum):
    """What a record of the journal carries."""

    HEADER = 1
    HIT = 2
    LOSS = 3
    MARK = 4
    END = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """A complete record, somewhere in `data`."""

    kind: int  # a RecordKind, or a kind this version does not know
    offset: int  # of the record's first byte in the journal
    end: int  # offset behind its last byte
    data: JournalBytes

    @property
    def payload(self) -> memoryview:
        """What it carries, read when it is asked for."""
        return self.data.piece(self.offset + _HEAD.size, self.end - _CRC.size)

    @property
    def whole(self) -> memoryview:
        """Head, payload and CRC."""
        return self.data.piece(self.offset, self.end)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """What a journal holds up to its end or its first damaged byte.

    Appending may go on at `good_end` once the file is cut there, provided `may_append`.
    """

    records: tuple[Record, ...]
    good_end: int  # bytes: offset behind the last complete record
    size: int  # bytes scanned
    damage: str  # what is wrong at good_end; empty if nothing is
    records_beyond: int  # complete records found behind the damage; they are not in `records`

    @property
    def dropped_bytes(self) -> int:
        """Bytes behind the last complete record."""
        return self.size - self.good_end

    @property
    def may_append(self) -> bool:
        """Whether cutting at `good_end` loses no complete record."""
        return self.records_beyond == 0


def encode_record(kind: RecordKind, payload: bytes) -> bytes:
    """Return the bytes of one record: head, payload, CRC-32 over both.

    Raises
    ------
    JournalError
        If the payload is larger than `MAX_PAYLOAD`.
    """
    if len(payload) > MAX_PAYLOAD:
        raise JournalError(
            f"a journal record holds at most {MAX_PAYLOAD} bytes, this one would hold "
            f"{len(payload)}: sample shorter blocks"
        )
    head = _HEAD.pack(len(payload), kind, SYNC)
    return b"".join((head, payload, _CRC.pack(zlib.crc32(payload, zlib.crc32(head)))))


def check_magic(data: bytes | memoryview) -> None:
    """Raise JournalError unless `data` begins as a journal this version can read."""
    start = bytes(data[: len(MAGIC)])
    if start == MAGIC:
        return
    if len(start) == len(MAGIC) and start[:-1] == MAGIC[:-1]:
        raise JournalError(
            f"wanted a journal of version {JOURNAL_VERSION}, this one is version {start[-1]}: "
            "read it with the armodal that wrote it, or a later one"
        )
    if not start or MAGIC.startswith(start):
        raise JournalError(
            f"the journal ends after {len(start)} bytes, before anything was recorded: "
            "remove it, and begin the session anew"
        )
    raise JournalError(
        "not an armodal journal: its first bytes are not those of one; give the path of the "
        ".journal file that acquisition wrote"
    )


def scan(data: bytes | memoryview | JournalBytes) -> Scan:
    """Return the complete records of a journal, up to the first torn or corrupt one.

    Parameters
    ----------
    data
        The whole journal, magic included.

    Raises
    ------
    JournalError
        If it does not begin as a journal, or is larger than `MAX_JOURNAL` bytes or
        `MAX_RECORDS` records.
    """
    source = InMemory(data) if isinstance(data, bytes | memoryview) else data
    if source.size > MAX_JOURNAL:
        raise JournalError(
            f"a journal holds at most {MAX_JOURNAL} bytes, this one holds {source.size}: "
            "give the path of the .journal file that acquisition wrote"
        )
    check_magic(source.piece(0, min(len(MAGIC), source.size)))
    records: list[Record] = []
    position = len(MAGIC)
    damage = ""
    while position < source.size:
        record, damage = record_at(source, position)
        if record is None:
            break
        records.append(record)
        if len(records) > MAX_RECORDS:
            raise JournalError(
                f"a journal holds at most {MAX_RECORDS} records, this one holds more: "
                "it was not written by acquisition"
            )
        position = record.end
    return Scan(
        records=tuple(records),
        good_end=position,
        size=source.size,
        damage=damage,
        records_beyond=sum(1 for _ in Search(source, position + 1)) if damage else 0,
    )


def record_at(data: JournalBytes, offset: int) -> tuple[Record | None, str]:
    """Return the record at `offset`, or None and what is wrong with it."""
    left = data.size - offset
    if left < RECORD_OVERHEAD:
        return None, f"{left} bytes are too few for a record"
    length, kind, sync = _HEAD.unpack(data.piece(offset, offset + _HEAD.size))
    if sync != SYNC:
        return None, f"no record head (sync {sync:#06x}, wanted {SYNC:#06x})"
    if length > MAX_PAYLOAD:
        return None, f"the length {length} is more than a record may hold ({MAX_PAYLOAD})"
    if length > left - RECORD_OVERHEAD:
        return None, f"the record wants {length + RECORD_OVERHEAD} bytes, only {left} are there"
    end = offset + _HEAD.size + length
    told = _CRC.unpack(data.piece(end, end + _CRC.size))[0]
    found = 0
    for part in pieces(data, offset, end):
        found = zlib.crc32(part, found)
    if found != told:
        return None, f"the CRC-32 is {found:#010x}, the record says {told:#010x}"
    return Record(kind=kind, offset=offset, end=end + _CRC.size, data=data), ""


class Search:
    """The complete records behind damage, wherever they begin, in turn.

    One that lies within another is not looked for. The work is bounded by the bytes searched.

    Attributes
    ----------
    gave_up_at : int or None
        The byte from which on nothing was looked at, where the work was too much.
    """

    def __init__(self, data: JournalBytes, start: int) -> None:
        self._data = data
        self._start = start
        self.gave_up_at: int | None = None

    def __iter__(self) -> Iterator[Record]:
        """Yield one after the other."""
        data, position = self._data, self._start
        budget = _SEARCH_FACTOR * (data.size - position)
        while position + RECORD_OVERHEAD <= data.size:
            position = max(position, data.hole_end(position) - RECORD_OVERHEAD)
            window_end = min(position + PIECE + RECORD_OVERHEAD, data.size)
            free_from = position
            for at, length in _places(data, position, window_end):
                if at < free_from:
                    continue
                if budget <= 0:
                    self.gave_up_at = at
                    return
                record, _ = record_at(data, at)
                if record is None:
                    budget -= _PLACE_COST + length
                    continue
                yield record
                free_from = record.end
            position = max(window_end - RECORD_OVERHEAD + 1, free_from)


def _places(data: JournalBytes, begin: int, end: int) -> list[tuple[int, int]]:
    """Return where a record's head may be that has room behind it, and the length it tells."""
    window = data.piece(begin, end)
    if bytes(window).find(_SYNC_BYTES) < 0:
        return []
    octets = np.frombuffer(window, dtype=np.uint8)
    syncs = octets[_SYNC_OFFSET:-5] == _SYNC_BYTES[0]
    syncs &= octets[_SYNC_OFFSET + 1 : -4] == _SYNC_BYTES[1]
    syncs &= octets[_SYNC_OFFSET - 1 : -6] == 0  # kinds are below 256
    heads = np.flatnonzero(syncs)
    lengths = octets[heads[:, None] + np.arange(4)].view("<u4")[:, 0].astype(np.int64)
    room = np.minimum(MAX_PAYLOAD, data.size - begin - heads - RECORD_OVERHEAD)
    fits = lengths <= room
    return list(zip((begin + heads[fits]).tolist(), lengths[fits].tolist(), strict=True))
