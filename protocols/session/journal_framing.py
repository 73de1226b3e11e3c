"""Framing of the journal: magic, records with length, kind and CRC-32, and the scan back.

The bytes are specified in `docs/journal.md`. Nothing here knows what a payload means.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

from armodal.protocols.errors import JournalError

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
    "encode_record",
    "scan",
]

JOURNAL_VERSION = 1
MAGIC = b"\x89AMJ\r\n\x1a" + bytes([JOURNAL_VERSION])

MAX_PAYLOAD = 64 * 2**20  # bytes: a hit of 16 million samples
MAX_RECORDS = 200_000
MAX_JOURNAL = 2**31  # bytes

SYNC = 0x4A52  # constant in every record head, so that records beyond damage can be found
_HEAD = struct.Struct("<IHH")
_CRC = struct.Struct("<I")
RECORD_OVERHEAD = _HEAD.size + _CRC.size
_SYNC_BYTES = struct.pack("<H", SYNC)
_SYNC_OFFSET = 6
_SEARCH_FACTOR = 2  # bytes summed at most, per byte searched, looking for records beyond damage
_SEARCH_CANDIDATES = 100_000  # places tried at most


class RecordKind(IntEnum):
    """What a record of the journal carries."""

    HEADER = 1
    HIT = 2
    LOSS = 3
    MARK = 4
    END = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """A complete record; `payload` is a view into the scanned bytes."""

    kind: int  # a RecordKind, or a kind this version does not know
    payload: memoryview
    offset: int  # of the record's first byte in the journal


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
        f"not an armodal journal: it begins with {start.hex(' ')}, wanted {MAGIC.hex(' ')}; "
        "give the path of the .journal file that acquisition wrote"
    )


def scan(data: bytes | memoryview) -> Scan:
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
    view = memoryview(data)
    if len(view) > MAX_JOURNAL:
        raise JournalError(
            f"a journal holds at most {MAX_JOURNAL} bytes, this one holds {len(view)}: "
            "give the path of the .journal file that acquisition wrote"
        )
    check_magic(view)
    records: list[Record] = []
    position = len(MAGIC)
    damage = ""
    while position < len(view):
        record, damage = _record_at(view, position)
        if record is None:
            break
        records.append(record)
        if len(records) > MAX_RECORDS:
            raise JournalError(
                f"a journal holds at most {MAX_RECORDS} records, this one holds more: "
                "it was not written by acquisition"
            )
        position += RECORD_OVERHEAD + len(record.payload)
    return Scan(
        records=tuple(records),
        good_end=position,
        size=len(view),
        damage=damage,
        records_beyond=_count_beyond(view, position + 1) if damage else 0,
    )


def _record_at(view: memoryview, offset: int) -> tuple[Record | None, str]:
    """Return the record at `offset`, or None and what is wrong with it."""
    left = len(view) - offset
    if left < RECORD_OVERHEAD:
        return None, f"{left} bytes are too few for a record"
    length, kind, sync = _HEAD.unpack_from(view, offset)
    if sync != SYNC:
        return None, f"no record head (sync {sync:#06x}, wanted {SYNC:#06x})"
    if length > MAX_PAYLOAD:
        return None, f"the length {length} is more than a record may hold ({MAX_PAYLOAD})"
    if length > left - RECORD_OVERHEAD:
        return None, f"the record wants {length + RECORD_OVERHEAD} bytes, only {left} are there"
    end = offset + _HEAD.size + length
    told = _CRC.unpack_from(view, end)[0]
    found = zlib.crc32(view[offset:end])
    if found != told:
        return None, f"the CRC-32 is {found:#010x}, the record says {told:#010x}"
    return Record(kind=kind, payload=view[offset + _HEAD.size : end], offset=offset), ""


def _count_beyond(view: memoryview, start: int) -> int:
    """Count complete records behind damage, with work bounded by the bytes searched."""
    tail = bytes(view[start:])
    budget = _SEARCH_FACTOR * len(tail)
    count = 0
    position = 0
    for _ in range(_SEARCH_CANDIDATES):
        found = tail.find(_SYNC_BYTES, position + _SYNC_OFFSET)
        if found < 0 or budget <= 0:
            break
        position = found - _SYNC_OFFSET
        length = _HEAD.unpack_from(tail, position)[0] if position + _HEAD.size <= len(tail) else 0
        if length <= min(MAX_PAYLOAD, len(tail) - position - RECORD_OVERHEAD):
            budget -= length + RECORD_OVERHEAD
            if _record_at(memoryview(tail), position)[0] is not None:
                count += 1
                position += RECORD_OVERHEAD + length
                continue
        position += 1
    return count
