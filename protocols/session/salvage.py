"""Every whole record of a damaged journal, sorted into the sessions it came from.

A journal is read from record to record; behind damage the next whole one is looked for. Records
but the HEADER carry no session's name, so where one file holds several sessions a hit goes by
what it says: the plan and arm it fits, the run of the board it was taken in, its number.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from armodal.protocols.errors import ArmodalError, JournalError
from armodal.protocols.session.journal import (
    MAGIC,
    Mark,
    MarkKind,
    Record,
    RecordKind,
    decode_record,
    encode_hit,
    encode_mark,
)
from armodal.protocols.session.journal_bytes import JournalBytes, is_zeros
from armodal.protocols.session.journal_framing import MAX_RECORDS, Search, record_at
from armodal.protocols.session.journal_header import begin_journal, decode_header
from armodal.protocols.session.membership import check_membership
from armodal.protocols.session.records import Hit, SessionHeader

__all__ = ["Salvage", "SalvagedSession", "salvage"]

# Two hits are of one run of the board if they put its START so near: clocks drift by less from
# hit to hit, and nobody starts a board twice within it. Host seconds.
_SAME_START_S = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class SalvagedSession:
    """What was taken of one session; `hits` counts the accepted and the rejected."""

    header: SessionHeader
    records: tuple[Record | bytes, ...]  # behind the HEADER; bytes where one had to be changed
    hits: int
    notes: tuple[str, ...]  # what was resolved, one sentence each

    def parts(self) -> Iterator[bytes | memoryview]:
        """Yield the bytes of a journal of this session alone."""
        yield begin_journal(self.header)
        for record in self.records:
            yield record.whole if isinstance(record, Record) else record


@dataclass(frozen=True, slots=True, kw_only=True)
class Salvage:
    """What was taken of a damaged journal, and what was not."""

    sessions: tuple[SalvagedSession, ...]
    taken: int  # whole records in `sessions`, HEADERs among them
    dropped: tuple[str, ...]  # whole records that were not taken, and damage, one sentence each


class _Sorted:
    """A session while its records are gathered."""

    def __init__(self, header: SessionHeader, offset: int) -> None:
        self.header = header
        self.offset = offset
        self.records: list[Record | bytes] = []
        self.hits = 0
        self.last = 0  # the highest number given
        self.last_told = 0  # the highest number a run told
        self.named: dict[int, list[int]] = {}  # number told: numbers given
        self.seen: set[bytes] = set()
        self.notes: list[str] = []

    def start_of(self, hit: Hit) -> float:
        """Return when the board was started, by the clocks of a hit."""
        rate = float(self.header.plan.sampling.rate_hz) * self.header.time_scale
        return hit.trigger_host_s - hit.trigger_sample / rate

    def why_not(self, hit: Hit) -> str:
        """Return why a hit cannot be of this session; empty if it can."""
        try:
            check_membership(hit, self.header, None)
        except JournalError as error:
            return str(error)
        return ""

    def take_hit(self, hit: Hit, record: Record) -> None:
        """Take a hit, under another number where its own is not higher than all before."""
        number = hit.number if hit.number > self.last else self.last + 1
        if number == hit.number:
            self.records.append(record)
        else:
            self.records.append(encode_hit(replace(hit, number=number)))
            self.notes.append(f"hit {hit.number} at byte {record.offset} is now hit {number}")
        self.named.setdefault(hit.number, []).append(number)
        self.hits, self.last = self.hits + 1, number

    def take_mark(self, mark: Mark, record: Record) -> None:
        """Take a mark; one that withdraws a hit withdraws all hits that told its number."""
        numbers = self.named.get(mark.hit or 0, [])
        if mark.kind is not MarkKind.WITHDRAWN or numbers in ([], [mark.hit]):
            self.records.append(record)
            return
        self.records.extend(encode_mark(replace(mark, hit=number)) for number in numbers)
        self.notes.append(
            f"hit {mark.hit} was withdrawn: that is hit {' and '.join(map(str, numbers))} now"
        )


def salvage(data: JournalBytes, *, header: SessionHeader | None = None) -> Salvage:
    """Take every whole record of a journal, however damaged.

    Parameters
    ----------
    header
        Of the session, from elsewhere, for a journal whose own HEADER is lost.

    Raises
    ------
    JournalError
        If nothing can be taken: no whole HEADER is there and none was given.
    """
    records, dropped = _whole_records(data)
    sessions = _sessions(records, header, dropped)
    if not sessions:
        others = f"; {len(records)} other whole records are there" if records else ""
        raise JournalError(
            f"no whole HEADER is in the journal, so nothing tells what arm and plan its hits "
            f"are of{others}; give another journal of the same arm and plan, with --header"
        )
    all_sessions = list(sessions.values())
    taken = sum(record.kind == RecordKind.HEADER for record in records)
    home = _homes(records, all_sessions)
    current = all_sessions[0]
    for record in records:
        if record.kind == RecordKind.HEADER:
            current = next((s for s in all_sessions if s.offset == record.offset), current)
            continue
        try:
            current = home.get(record.offset, current)
            _take(record, current)
            taken += 1
        except ArmodalError as error:
            dropped.append(f"the record at byte {record.offset}: {error}")
    return Salvage(
        sessions=tuple(
            SalvagedSession(
                header=session.header,
                records=tuple(session.records),
                hits=session.hits,
                notes=tuple(session.notes),
            )
            for session in all_sessions
        ),
        taken=taken,
        dropped=tuple(dropped),
    )


def _whole_records(data: JournalBytes) -> tuple[list[Record], list[str]]:
    """Return all whole records in the order they stand, and what to tell of the bytes between."""
    position = len(MAGIC) if _is_magic(data, 0) else 0
    records: list[Record] = []
    while position < data.size and (record := record_at(data, position)[0]) is not None:
        records.append(record)
        position = record.end
    search = Search(data, position)
    records.extend(itertools.islice(search, MAX_RECORDS))
    ends = [len(MAGIC) if _is_magic(data, 0) else 0, *(record.end for record in records)]
    begins = [*(record.offset for record in records), data.size]
    told = [said for gap in zip(ends, begins, strict=True) for said in _damage(data, *gap)]
    if search.gave_up_at is not None:
        told.append(f"from byte {search.gave_up_at} on nothing was looked at: too many false heads")
    return records, told


def _is_magic(data: JournalBytes, at: int) -> bool:
    return bytes(data.piece(at, min(at + len(MAGIC), data.size))) == MAGIC


def _damage(data: JournalBytes, begin: int, end: int) -> list[str]:
    """Return what to tell of bytes that hold no whole record."""
    if begin == end or (end - begin == len(MAGIC) and _is_magic(data, begin)):
        return []
    what = "are zeros, a hole" if is_zeros(data, begin, end) else "hold no whole record"
    return [f"the {end - begin} bytes from byte {begin} on {what}"]


def _sessions(
    records: Sequence[Record], header: SessionHeader | None, dropped: list[str]
) -> dict[bytes, _Sorted]:
    """Return the sessions whose HEADERs are there, each once; else the one given."""
    found: dict[bytes, _Sorted] = {}
    for record in records:
        if record.kind != RecordKind.HEADER:
            continue
        digest = _digest(record)
        if digest in found:
            dropped.append(f"the HEADER at byte {record.offset} stands there twice")
            continue
        try:
            found[digest] = _Sorted(decode_header(record.payload), record.offset)
        except ArmodalError as error:
            dropped.append(f"the HEADER at byte {record.offset}: {error}")
    if not found and header is not None:
        found[b""] = _Sorted(header, 0)
    return found


@dataclass(slots=True)
class _Run:
    """Hits of one run of the board: their numbers rise, and they agree when it was started."""

    fitting: list[_Sorted]
    offset: int
    first: int
    last: int
    start_s: float
    offsets: list[int]


def _homes(records: Sequence[Record], sessions: Sequence[_Sorted]) -> dict[int, _Sorted]:
    """Return which session each hit belongs to, by the offset of its record."""
    runs: list[_Run] = []
    resumed: list[int] = []
    seen: set[bytes] = set()
    for record in records:
        if record.kind not in (RecordKind.HIT, RecordKind.MARK) or _digest(record) in seen:
            continue
        seen.add(_digest(record))
        with suppress(ArmodalError):  # told where it is taken
            item = decode_record(record)
            if isinstance(item, Mark) and item.kind is MarkKind.RESUMED:
                resumed.append(record.offset)
            elif isinstance(item, Hit) and (fit := [s for s in sessions if not s.why_not(item)]):
                _put_in_run(item, record.offset, fit, runs)
    home: dict[int, _Sorted] = {}
    for run in runs:
        free = [s for s in run.fitting if s.offset <= run.offset and run.first > s.last_told]
        session = _likeliest(run, free or run.fitting, resumed)
        if len(free) > 1:
            session.notes.append(
                f"{len(run.offsets)} hits from byte {run.offset} on may be of another session: "
                "only numbers and the order in the file tell"
            )
        session.last_told = max(session.last_told, run.last)
        home |= dict.fromkeys(run.offsets, session)
    return home


def _likeliest(run: _Run, sessions: list[_Sorted], resumed: Sequence[int]) -> _Sorted:
    """Return the session begun last, or where one was resumed since, the one that is continued."""
    latest = max(sessions, key=lambda s: s.offset)
    if any(latest.offset < offset < run.offset for offset in resumed):
        return min(sessions, key=lambda s: abs(run.first - s.last_told - 1))
    return latest


def _put_in_run(hit: Hit, offset: int, fitting: list[_Sorted], runs: list[_Run]) -> None:
    start_s = fitting[0].start_of(hit)
    near = [
        run
        for run in runs
        if run.fitting == fitting
        and abs(run.start_s - start_s) <= _SAME_START_S
        and hit.number > run.last
    ]
    if not near:
        runs.append(_Run(fitting, offset, hit.number, hit.number, start_s, [offset]))
        return
    run = min(near, key=lambda run: abs(run.start_s - start_s))
    run.last, run.start_s = hit.number, start_s
    run.offsets.append(offset)


def _take(record: Record, session: _Sorted) -> None:
    """Take a record into its session; raise where it belongs to none."""
    digest = _digest(record)
    if digest in session.seen:
        raise JournalError("it stands there twice")
    item = decode_record(record)
    if isinstance(item, Hit):
        if why := session.why_not(item):
            raise JournalError(why)
        session.take_hit(item, record)
    elif isinstance(item, Mark):
        session.take_mark(item, record)
    else:
        session.records.append(record)
    session.seen.add(digest)


def _digest(record: Record) -> bytes:
    return hashlib.sha256(record.payload).digest() + record.kind.to_bytes(2, "little")
