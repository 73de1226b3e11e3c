"""Whether a disk after a stop holds every hit that was announced as accepted."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.errors import JournalError, SessionError
from armodal.protocols.session import header
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal import (
    Mark,
    MarkKind,
    decode_journal,
    encode_mark,
    read_journal,
    session_of,
)
from armodal.protocols.session.records import Hit, Session
from armodal.protocols.session.recovery import rebuild

AGAIN = encode_mark(Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=0.0, note="again"))


# Thousands of disks hold the same arm's text, which takes longest to read: a pure function.
header.arm_from_texts = cache(header.arm_from_texts)


def quick_folder() -> tempfile.TemporaryDirectory[str]:
    """Make a folder for disks that are only laid out: in memory, where there is such a place."""
    return tempfile.TemporaryDirectory(dir=quick_place())


def quick_place() -> Path | None:
    """Return where files lie in memory; None where there is no such place."""
    memory = Path("/dev/shm")  # noqa: S108 - only folders of random names are made there
    return memory if memory.is_dir() else None


def laid_out(files: Mapping[str, bytes], folder: Path) -> None:
    """Make a folder hold exactly these files."""
    for path in folder.iterdir():
        path.unlink()
    for name, data in files.items():
        (folder / name).write_bytes(data)


_WHOLE: set[bytes] = set()


def _check_whole(data: bytes, path: Path) -> None:
    """Read a session file, unless one of the same bytes has been read."""
    digest = hashlib.sha256(data).digest()
    if digest not in _WHOLE:
        read_session(path)
        _WHOLE.add(digest)


def missing(announced: Mapping[int, Hit], session: Session) -> str | None:
    """Return what is wrong with the announced hits of a session, if anything."""
    there = {hit.number: hit for hit in session.hits}
    for number, hit in announced.items():
        if number not in there:
            return f"hit {number} is lost"
        difference = first_difference(there[number], hit, f"hit {number}")
        if difference is not None:
            return f"{difference} is not what was measured"
    return None


def wrong_after_stop(
    files: Mapping[str, bytes], announced: Mapping[int, Hit], folder: Path, journal: str
) -> str | None:
    """Recover and resume from these files; return what is wrong, if anything.

    `armodal recover` must bring back all announced hits and say what it dropped, and the session
    must go on. A session file that is there must be whole.
    """
    laid_out(files, folder)
    try:
        for name, data in files.items():
            if name.endswith(".h5"):
                _check_whole(data, folder / name)
    except SessionError as error:
        return f"a session file is not whole: {error}"
    path = folder / journal
    data = files.get(journal, b"")
    try:
        found = decode_journal(data)
        session = _recovered(path, data[: found.good_end]) or session_of(found)
    except JournalError as error:
        return f"not recovered: {error}" if announced else None
    wrong = missing(announced, session)
    if wrong is not None:
        return wrong
    told = " ".join(found.warnings)
    if found.dropped_bytes and f"the {found.dropped_bytes} bytes behind are dropped" not in told:
        return f"{found.dropped_bytes} bytes were dropped without a word"
    return _wrong_after_resuming(path, announced, found.dropped_bytes)


def _recovered(path: Path, whole: bytes) -> Session | None:
    """Return the session file that `armodal recover` makes; None if it made the same before.

    What is written depends on the whole records alone, so it is written once for each of them.
    """
    digest = hashlib.sha256(whole).digest()
    if digest in _WHOLE:
        return None
    made = path.with_name("recovered.h5")
    rebuild(path, made, software="torture")
    _WHOLE.add(digest)
    return read_session(made)


def _wrong_after_resuming(
    path: Path, announced: Mapping[int, Hit], dropped_bytes: int
) -> str | None:
    before = path.read_bytes()
    try:
        writer, _ = JournalWriter.resume(path)
    except JournalError as error:
        return f"not resumed: {error}"
    writer.append(AGAIN)
    writer.close()
    journal = read_journal(path)
    if journal.dropped_bytes or journal.marks[-1].note != "again":
        return "the session did not go on"
    if dropped_bytes:
        asides = [aside.read_bytes() for aside in path.parent.glob(f"{path.name}.torn-*")]
        if before[-dropped_bytes:] not in asides:
            return "the torn tail was not kept"
    here = {hit.number: hit for hit in journal.hits}
    return next((f"hit {n} is lost by resuming" for n in announced if n not in here), None)
