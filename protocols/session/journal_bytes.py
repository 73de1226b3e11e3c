"""Where a journal's bytes come from: memory, or a file that is read piece by piece."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from armodal.protocols.errors import JournalError
from armodal.protocols.os_words import os_words

__all__ = ["MAX_JOURNAL", "PIECE", "InMemory", "JournalBytes", "is_zeros", "journal_file", "pieces"]

MAX_JOURNAL = 2**31  # bytes
PIECE = 2**20  # bytes read at once where the whole is not wanted at once


class JournalBytes(Protocol):
    """A journal's bytes, `size` of them."""

    @property
    def size(self) -> int:
        """How many there are."""

    def piece(self, begin: int, end: int) -> memoryview:
        """Return the bytes from `begin` up to `end`, both at most `size`."""

    def hole_end(self, at: int) -> int:
        """Return where a hole that byte `at` lies in ends, as far as is known; `at` outside."""


class InMemory:
    """Bytes that are held already."""

    def __init__(self, data: bytes | memoryview) -> None:
        self._view = memoryview(data)

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self._view)

    def piece(self, begin: int, end: int) -> memoryview:
        """Return a view of them."""
        return self._view[begin:end]

    def hole_end(self, at: int) -> int:
        """Return `at`: memory has no holes."""
        return at


class _InFile:
    """A file's bytes, as many as there were when it was opened."""

    def __init__(self, fd: int, path: Path) -> None:
        self._fd = fd
        self._path = path
        self.size = os.fstat(fd).st_size

    def piece(self, begin: int, end: int) -> memoryview:
        """Read them."""
        os.lseek(self._fd, begin, os.SEEK_SET)
        parts: list[bytes] = []
        wanted = end - begin
        while wanted:
            try:
                parts.append(os.read(self._fd, wanted))
            except OSError as error:
                raise _cannot_read(self._path, error) from error
            if not parts[-1]:
                raise JournalError(
                    f"the journal {self._path} was cut while it was read: {wanted} bytes before "
                    f"byte {end} are gone; read it again"
                )
            wanted -= len(parts[-1])
        return memoryview(parts[0] if len(parts) == 1 else b"".join(parts))

    def hole_end(self, at: int) -> int:
        """Return where the file system has data again."""
        if sys.platform == "win32":
            return at
        try:
            return min(os.lseek(self._fd, at, os.SEEK_DATA), self.size)
        except OSError as error:
            return self.size if error.errno == errno.ENXIO else at


@contextmanager
def journal_file(path: Path) -> Iterator[JournalBytes]:
    """Open a journal to read it piece by piece; nothing is held.

    Raises
    ------
    JournalError
        If it cannot be read, is no plain file or is larger than `MAX_JOURNAL`.
    """
    if path.exists() and not path.is_file():  # opening a pipe would wait for its writer
        raise JournalError(f"cannot read the journal {path}: it is no plain file; give one")
    try:
        file = path.open("rb", buffering=0)
    except OSError as error:
        raise _cannot_read(path, error) from error
    with file:
        data = _InFile(file.fileno(), path)
        if data.size > MAX_JOURNAL:
            raise JournalError(f"{path} is larger than a journal may be ({MAX_JOURNAL} bytes)")
        yield data


def pieces(data: JournalBytes, begin: int, end: int) -> Iterator[memoryview]:
    """Yield the bytes from `begin` up to `end`, at most `PIECE` at once."""
    for at in range(begin, end, PIECE):
        yield data.piece(at, min(at + PIECE, end))


def is_zeros(data: JournalBytes, begin: int, end: int) -> bool:
    """Return whether all bytes from `begin` up to `end` are 0."""
    at = begin
    while (at := data.hole_end(at)) < end:
        until = min(at + PIECE, end)
        if bytes(data.piece(at, until)).strip(b"\0"):
            return False
        at = until
    return True


def _cannot_read(path: Path, error: OSError) -> JournalError:
    return JournalError(
        f"cannot read the journal {path}: {os_words(error)}; give the path of the .journal "
        "file that acquisition wrote"
    )
