"""The journal of a session: the record of what was measured.

Written append-only by acquisition; everything else is derived from it. The bytes are specified
in `docs/journal.md`. Encoders return bytes and open nothing; `read_journal` and `load_journal`
read a file back, torn tail dropped and said.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal_bytes import JournalBytes, journal_file
from armodal.protocols.session.journal_framing import (
    MAGIC,
    Record,
    RecordKind,
    Scan,
    encode_record,
    scan,
)
from armodal.protocols.session.journal_header import begin_journal, decode_header
from armodal.protocols.session.journal_payloads import (
    CALIBRATION,
    End,
    Mark,
    MarkKind,
    decode_end,
    decode_hit,
    decode_loss,
    decode_mark,
    encode_end,
    encode_hit,
    encode_loss,
    encode_mark,
)
from armodal.protocols.session.membership import check_membership
from armodal.protocols.session.moved_points import arm_with_moves, move_words
from armodal.protocols.session.operator_angles import angles_by_hand
from armodal.protocols.session.progress import is_complete
from armodal.protocols.session.records import Hit, Loss, Session, SessionHeader

__all__ = [
    "MAGIC",
    "End",
    "Journal",
    "Mark",
    "MarkKind",
    "Record",
    "RecordKind",
    "Scan",
    "begin_journal",
    "decode_journal",
    "decode_record",
    "encode_end",
    "encode_hit",
    "encode_loss",
    "encode_mark",
    "encode_record",
    "load_journal",
    "read_journal",
    "scan",
    "session_of",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Journal:
    """A journal read back.

    `good_end` is the byte behind the last complete record: where appending goes on after the
    file was cut there, which loses nothing as long as `may_append`.
    """

    header: SessionHeader
    hits: tuple[Hit, ...]
    losses: tuple[Loss, ...]
    marks: tuple[Mark, ...]
    end: End | None  # of the last closing that nothing followed; None while the session is open
    good_end: int
    size: int
    may_append: bool
    warnings: tuple[str, ...]

    @property
    def dropped_bytes(self) -> int:
        """Bytes behind the last complete record."""
        return self.size - self.good_end


def load_journal(path: str | Path) -> Session:
    """Read the session a journal holds, complete or interrupted.

    Raises
    ------
    JournalError
        If the file cannot be read, is not a journal, holds no complete HEADER, or a record
        with a valid CRC says something impossible.
    """
    return session_of(read_journal(path))


def read_journal(path: str | Path) -> Journal:
    """Read a journal file with its marks and the place where it may be continued."""
    with journal_file(Path(path)) as data:
        return decode_journal(data)


def session_of(journal: Journal) -> Session:
    """Return the session that a journal tells of, its arm with the points where they were measured.

    Skips, moves and calibrations become warnings.
    """
    arm = arm_with_moves(journal.header.arm, journal.marks)
    skipped = tuple(
        f"skipped: {_place(mark)}{': ' + mark.note if mark.note else ''}"
        for mark in journal.marks
        if mark.kind is MarkKind.SKIPPED
    )
    calibrated = tuple(
        mark.note
        for mark in journal.marks
        if mark.kind is MarkKind.NOTE and mark.note.startswith(CALIBRATION)
    )
    moved = move_words(journal.header.arm, arm)
    return Session(
        header=replace(journal.header, arm=arm),
        hits=journal.hits,
        losses=journal.losses,
        complete=is_complete(journal.header.plan, journal.hits),
        warnings=angles_by_hand(journal.header)
        + journal.header.arm.tolerances.remarks
        + journal.warnings
        + skipped
        + calibrated
        + moved,
    )


def decode_journal(data: bytes | JournalBytes) -> Journal:
    """Return the journal that `data` holds, from its magic on; errors as `load_journal`."""
    found = scan(data)
    if not found.records:
        raise JournalError(
            f"the journal holds no complete record: {found.damage or 'it ends after its magic'}; "
            "nothing was recorded in it; remove it, and begin the session anew"
        )
    header = _header(found.records[0])
    hits: list[Hit] = []
    losses: list[Loss] = []
    marks: list[Mark] = []
    end: End | None = None
    unknown = 0
    for record in found.records[1:]:
        end = None
        item = decode_record(record)
        if isinstance(item, Hit):
            _check_hit(item, header, hits, record.offset)
            hits.append(item)
        elif isinstance(item, Loss):
            losses.append(item)
        elif isinstance(item, Mark):
            marks.append(item)
        elif isinstance(item, End):
            end = item
        else:
            unknown += 1
    return Journal(
        header=header,
        hits=_after_withdrawals(hits, marks),
        losses=tuple(losses),
        marks=tuple(marks),
        end=end,
        good_end=found.good_end,
        size=found.size,
        may_append=found.may_append,
        warnings=_warnings(found, unknown, closed=end is not None),
    )


def _after_withdrawals(hits: Sequence[Hit], marks: Sequence[Mark]) -> tuple[Hit, ...]:
    """Return the hits as they count: one that was withdrawn stays, and is not accepted."""
    withdrawn = {mark.hit for mark in marks if mark.kind is MarkKind.WITHDRAWN}
    return tuple(
        replace(
            hit,
            verdict=replace(
                hit.verdict, accepted=False, reasons=(*hit.verdict.reasons, "withdrawn")
            ),
        )
        if hit.number in withdrawn and hit.verdict.accepted
        else hit
        for hit in hits
    )


_WAY_OUT = "armodal recover --salvage takes every record that is whole"

_DECODERS: dict[int, Callable[[memoryview], Hit | Loss | Mark | End]] = {
    RecordKind.HIT: decode_hit,
    RecordKind.LOSS: decode_loss,
    RecordKind.MARK: decode_mark,
    RecordKind.END: decode_end,
}


def decode_record(record: Record) -> Hit | Loss | Mark | End | None:
    """Return what a record says, or None if its kind is not known."""
    if record.kind == RecordKind.HEADER:
        raise JournalError(f"journal record at byte {record.offset}: a second HEADER; {_WAY_OUT}")
    decoder = _DECODERS.get(record.kind)
    if decoder is None:
        return None
    try:
        return decoder(record.payload)
    except JournalError as error:
        raise JournalError(
            f"journal record at byte {record.offset}: {error}; {_WAY_OUT}"
        ) from error


def _header(record: Record) -> SessionHeader:
    if record.kind != RecordKind.HEADER:
        raise JournalError(f"a journal begins with HEADER, this one with kind {record.kind}")
    return decode_header(record.payload)


def _check_hit(hit: Hit, header: SessionHeader, before: Sequence[Hit], offset: int) -> None:
    try:
        check_membership(hit, header, before[-1] if before else None)
    except JournalError as error:
        raise JournalError(f"journal record at byte {offset}: {error}; {_WAY_OUT}") from error


def _warnings(found: Scan, unknown: int, *, closed: bool) -> tuple[str, ...]:
    warnings = []
    if found.damage:
        warnings.append(
            f"the journal is whole up to byte {found.good_end}; the {found.dropped_bytes} bytes "
            f"behind are dropped: {found.damage}"
        )
    if found.records_beyond:
        warnings.append(
            f"{found.records_beyond} complete records lie behind the damage and are not used: "
            "keep the journal; armodal recover --salvage takes them"
        )
    if unknown:
        warnings.append(f"{unknown} records of a kind this version does not know were passed over")
    if not closed:
        warnings.append("the session was not closed: it was interrupted, or is still running")
    return tuple(warnings)


def _place(mark: Mark) -> str:
    posture = "" if mark.posture is None else f"posture {mark.posture}"
    point = "" if mark.point is None else f"point {mark.point}"
    return ", ".join(part for part in (posture, point) if part) or "a step"
