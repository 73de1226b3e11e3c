"""The journal on disk: a record counts once it is durable, and not before."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from armodal.daq.journal_watch import rescue, what_happened_to
from armodal.daq.session_lock import SessionLock, lock_journal, lock_open_journal
from armodal.protocols.errors import JournalError
from armodal.protocols.file_layer import DISK, FileLayer, write_all
from armodal.protocols.os_words import os_words
from armodal.protocols.session.journal import (
    Journal,
    Record,
    begin_journal,
    decode_journal,
    scan,
)
from armodal.protocols.session.journal_bytes import MAX_JOURNAL, journal_file, pieces
from armodal.protocols.session.journal_framing import MAX_RECORDS
from armodal.protocols.session.records import SessionHeader

__all__ = ["JournalWriter"]

# Kept free for the last losses, the reason and END: each of them is below 64 KiB.
LAST_RECORDS = 64
LAST_BYTES = 4 * 2**20


class JournalWriter:
    """A journal open for appending, locked against a second writer.

    Made by `create` or `resume`.

    Attributes
    ----------
    path : Path
        The file.
    last_commit_s : float
        Wall seconds the last `append` took.
    """

    def __init__(self, path: Path, fd: int, lock: SessionLock, files: FileLayer) -> None:
        self.path = path
        self.last_commit_s = 0.0
        self._there = path.resolve()
        self._kept: list[bytes] = []  # all the journal holds, should somebody take it away
        self._end = 0
        self._fd = fd
        self._lock = lock
        self._files = files
        self._broken = False
        self._records = 0
        self._ending = False

    @classmethod
    def create(cls, path: Path, header: SessionHeader, *, files: FileLayer = DISK) -> JournalWriter:
        """Begin a journal in a file that must not exist yet, readable by its user only.

        If that fails, there is no file afterwards.

        Raises
        ------
        JournalError
            If it exists or cannot be written.
        """
        try:
            lock, fd = _locked(path, files.create, files)
        except FileExistsError:
            raise JournalError(
                f"{path} exists already: resume that session, or give another name"
            ) from None
        except OSError as error:
            raise _cannot("begin", path, error) from error
        writer = cls(path, fd, lock, files)
        try:
            writer.append(begin_journal(header))
            files.sync_folder(path.parent)
        except BaseException as error:
            with suppress(OSError):
                files.remove(path)
            writer.close()
            if isinstance(error, OSError):
                raise _cannot("begin", path, error) from error
            raise
        return writer

    @classmethod
    def resume(cls, path: Path, *, files: FileLayer = DISK) -> tuple[JournalWriter, Journal]:
        """Open a journal to go on with it, and return what it holds, which is durable then.

        Bytes of a torn last record are copied to a file beside it before they are cut off.

        Raises
        ------
        JournalError
            If it cannot be read or written, is in use, or holds records behind damage.
        """
        try:
            lock, fd = _locked(path, files.open, files)
        except OSError as error:
            raise _cannot("resume", path, error) from error
        writer = cls(path, fd, lock, files)
        try:
            with journal_file(path) as data:
                journal = decode_journal(data)
                _check_may_append(path, journal)
                records = scan(data).records
                whole = bytes(data.piece(0, journal.good_end))
                if journal.dropped_bytes:
                    writer._keep_aside(pieces(data, journal.good_end, data.size))
                    files.cut(fd, journal.good_end)
            # What a killed session wrote last may be in the system's memory only. And what a
            # refused sync held, the system takes for written: only if it is written again will
            # it be.
            writer._records = len(records)
            writer._kept, writer._end = [whole], journal.good_end
            last = _last_begins(records)
            files.rewrite(path, whole[last:], last)
            files.sync(fd)
            files.sync_folder(path.parent)
        except OSError as error:
            writer.close()
            raise _cannot("resume", path, error) from error
        except BaseException:
            writer.close()
            raise
        return writer, journal

    def append(self, record: bytes) -> float:
        """Append a record and return, once it is durable, the wall seconds that took.

        After a refusal nobody knows what reached the disk, so nothing is appended behind it any
        more: what was written of the record is cut off again, and the session must end. So it must
        where the file was removed, replaced, cut or written to by somebody else: all records that
        counted are then written to a file of their own.

        Raises
        ------
        JournalError
            If the disk refuses, or refused before, or the journal would be longer than a reader
            takes, or the file is no longer the one that is written; the record then does not count.
        """
        if self._broken:
            raise JournalError(
                f"{self.path} takes no more records since one was refused: resume the session"
            )
        begun = time.monotonic()
        self._check_still_there()
        good_end = self._end
        self._check_room(good_end + len(record))
        try:
            write_all(self._files, self._fd, record)
            self._files.sync(self._fd)
        except OSError as error:
            self._broken = True
            with suppress(OSError):
                self._files.cut(self._fd, good_end)
            raise _cannot("write", self.path, error) from error
        self._end = good_end + len(record)
        self._check_still_there()
        self._kept.append(record)
        self._records += 1
        self.last_commit_s = time.monotonic() - begun
        return self.last_commit_s

    def held(self) -> bytes:
        """Return what the journal holds that counts."""
        self._kept = [b"".join(self._kept)]
        return self._kept[0]

    def take_back(self) -> None:
        """Cut off the record that was appended last, which then does not count; end here."""
        self._broken = True
        self._end -= len(self._kept.pop())
        self._records -= 1
        with suppress(OSError):
            self._files.cut(self._fd, self._end)

    def end_here(self) -> None:
        """Take no more records."""
        self._broken = True

    def begin_ending(self) -> None:
        """Let the records that follow, a session's last ones, take the room kept for them."""
        self._ending = True

    def close(self) -> None:
        """Close the file and give the lock back."""
        if self._fd >= 0:
            with suppress(OSError):
                self._files.close(self._fd)
            self._fd = -1
        self._lock.release()

    def _check_still_there(self) -> None:
        happened = what_happened_to(self._there, self._fd, self._end)
        if not happened:
            return
        self._broken = True
        saved = rescue(self._there, self._kept, self._files)
        where = (
            "and no folder takes a copy of what it held; end nothing, and copy it by hand"
            if saved is None
            else f"what it held, {self._records} records, is safe in {saved}: resume that"
        )
        raise JournalError(
            f"THE JOURNAL {self.path} {happened} while it was written; the hit in hand is not "
            f"accepted, {where}"
        )

    def _check_room(self, size: int) -> None:
        most_records, most_bytes = MAX_RECORDS, MAX_JOURNAL
        if not self._ending:
            most_records, most_bytes = most_records - LAST_RECORDS, most_bytes - LAST_BYTES
        if self._records >= most_records or size > most_bytes:
            raise JournalError(
                f"{self.path} is full: a journal takes {most_records} records and {most_bytes} "
                f"bytes, with the next record it would have {self._records + 1} and {size}; what "
                "it holds is safe; begin another session, in another journal"
            )

    def _keep_aside(self, torn: Iterable[memoryview]) -> None:
        number = 1
        while (aside := self.path.with_name(f"{self.path.name}.torn-{number}")).exists():
            number += 1
        fd = self._files.create(aside)
        try:
            for part in torn:
                write_all(self._files, fd, part)
            self._files.sync(fd)
            self._files.sync_folder(self.path.parent)
        except BaseException:
            with suppress(OSError):
                self._files.remove(aside)
            raise
        finally:
            self._files.close(fd)


def _locked(
    path: Path, open_file: Callable[[Path], int], files: FileLayer
) -> tuple[SessionLock, int]:
    lock = lock_journal(path.resolve())
    fd = -1
    try:
        fd = open_file(path)
        lock_open_journal(fd, path)
    except BaseException:
        if fd >= 0:
            files.close(fd)
        lock.release()
        raise
    return lock, fd


def _check_may_append(path: Path, journal: Journal) -> None:
    if not journal.may_append:
        raise JournalError(
            f"{path} is damaged at byte {journal.good_end} and holds complete records "
            "behind: it is left as it is; recover it, and begin another session"
        )


def _last_begins(records: Sequence[Record]) -> int:
    """Return where the last complete record begins; the first one goes with the magic."""
    return records[-1].offset if len(records) > 1 else 0


_WAYS_BACK = {
    "begin": "check path, rights and free space",
    "resume": "check path, rights and free space; nothing in it is lost",
    "write": (
        "the hit in hand is not accepted, all accepted before are safe; make the disk writable, "
        "or free space on it, and resume the session"
    ),
}


def _cannot(what: str, path: Path, error: OSError) -> JournalError:
    return JournalError(f"cannot {what} the journal {path}: {os_words(error)}; {_WAYS_BACK[what]}")
