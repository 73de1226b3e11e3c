"""The journal on disk: a record counts once it is durable, and not before."""

from __future__ import annotations

import fcntl
import os
import time
from contextlib import suppress
from pathlib import Path

from protocols.errors import JournalError
from protocols.session.journal import Journal, begin_journal, decode_journal
from protocols.session.records import SessionHeader

__all__ = ["JournalWriter"]


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

    def __init__(self, path: Path, fd: int) -> None:
        self.path = path
        self.last_commit_s = 0.0
        self._fd = fd
        self._broken = False

    @classmethod
    def create(cls, path: Path, header: SessionHeader) -> JournalWriter:
        """Begin a journal in a file that must not exist yet.

        Raises
        ------
        JournalError
            If it exists or cannot be written.
        """
        try:
            fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
        except FileExistsError:
            raise JournalError(
                f"{path} exists already: resume that session, or give another name"
            ) from None
        except OSError as error:
            raise _cannot("begin", path, error) from error
        writer = cls(path, fd)
        try:
            writer._lock()
            writer.append(begin_journal(header))
            _sync_directory(path.parent)
        except BaseException:
            writer.close()
            raise
        return writer

    @classmethod
    def resume(cls, path: Path) -> tuple[JournalWriter, Journal]:
        """Open a journal to go on with it, and return what it holds.

        Bytes of a torn last record are copied to a file beside it before they are cut off.

        Raises
        ------
        JournalError
            If it cannot be read or written, is in use, or holds records behind damage.
        """
        try:
            fd = os.open(path, os.O_RDWR | os.O_APPEND)
        except OSError as error:
            raise _cannot("resume", path, error) from error
        writer = cls(path, fd)
        try:
            writer._lock()
            data = path.read_bytes()
            journal = decode_journal(data)
            _check_may_append(path, journal)
            writer._cut(data, journal.good_end)
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
        more: what was written of the record is cut off again, and the session must end.

        Raises
        ------
        JournalError
            If the disk refuses, or refused before; the record then does not count.
        """
        if self._broken:
            raise JournalError(f"{self.path} takes no more records since the disk refused one")
        begun = time.monotonic()
        good_end = os.fstat(self._fd).st_size
        rest = memoryview(record)
        try:
            while rest:
                rest = rest[os.write(self._fd, rest) :]
            _make_durable(self._fd)
        except OSError as error:
            self._broken = True
            with suppress(OSError):
                os.ftruncate(self._fd, good_end)
            raise _cannot("write", self.path, error) from error
        self.last_commit_s = time.monotonic() - begun
        return self.last_commit_s

    def close(self) -> None:
        """Close the file and give the lock back."""
        if self._fd >= 0:
            with suppress(OSError):
                os.close(self._fd)
            self._fd = -1

    def _lock(self) -> None:
        try:
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise JournalError(
                f"{self.path} is being written by another session; wait for it to end"
            ) from None

    def _cut(self, data: bytes, good_end: int) -> None:
        if good_end == len(data):
            return
        number = 1
        while (aside := self.path.with_name(f"{self.path.name}.torn-{number}")).exists():
            number += 1
        with aside.open("xb") as file:
            file.write(data[good_end:])
            file.flush()
            os.fsync(file.fileno())
        _sync_directory(self.path.parent)
        os.ftruncate(self._fd, good_end)
        _make_durable(self._fd)


def _check_may_append(path: Path, journal: Journal) -> None:
    if not journal.may_append:
        raise JournalError(
            f"{path} is damaged at byte {journal.good_end} and holds complete records "
            "behind: it is left as it is; recover it, and begin another session"
        )


def _make_durable(fd: int) -> None:
    full_sync = getattr(fcntl, "F_FULLFSYNC", None)
    if full_sync is not None:  # macOS: fsync stops at the drive's own cache
        fcntl.fcntl(fd, full_sync)
    else:
        os.fdatasync(fd)


def _sync_directory(path: Path) -> None:
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def _cannot(what: str, path: Path, error: OSError) -> JournalError:
    return JournalError(
        f"cannot {what} the journal {path}: {error.strerror}; check path, rights and free space"
    )
