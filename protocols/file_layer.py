"""Every operation that changes a journal or a session file on the disk, in one place.

Whoever records passes one of these along, so that a test can note, stop or refuse each single
write, sync, cut and renaming (`docs/reliability.md`).
"""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import Protocol

if sys.platform != "win32":
    import fcntl

__all__ = ["DISK", "Disk", "FileLayer", "write_all"]

USER_ONLY = 0o600
_AS_IT_IS = getattr(os, "O_BINARY", 0)  # Windows: no translation of line ends


class FileLayer(Protocol):
    """What recording needs of a file system; every method may raise OSError."""

    def create(self, path: Path) -> int:
        """Make a file that must not exist yet, for its user only; return its descriptor."""

    def open(self, path: Path) -> int:
        """Open a file that exists, to read and append; return its descriptor."""

    def write(self, fd: int, data: bytes | memoryview) -> int:
        """Append bytes; return how many were taken."""

    def rewrite(self, path: Path, data: bytes, at: int) -> None:
        """Write bytes once more that are in a file already, from byte `at` on."""

    def sync(self, fd: int) -> None:
        """Return once everything written to the file is durable."""

    def cut(self, fd: int, size: int) -> None:
        """Drop everything behind byte `size`."""

    def close(self, fd: int) -> None:
        """Let go of the file."""

    def replace(self, source: Path, target: Path) -> None:
        """Rename a file over another one."""

    def remove(self, path: Path) -> None:
        """Remove a file."""

    def sync_folder(self, path: Path) -> None:
        """Return once the names in a folder are durable."""


class Disk:
    """The disk itself."""

    def create(self, path: Path) -> int:
        """Make a file that must not exist yet, for its user only."""
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | _AS_IT_IS
        return os.open(path, flags, USER_ONLY)

    def open(self, path: Path) -> int:
        """Open a file that exists, to read and append."""
        return os.open(path, os.O_RDWR | os.O_APPEND | _AS_IT_IS)

    def write(self, fd: int, data: bytes | memoryview) -> int:
        """Append bytes."""
        return os.write(fd, data)

    def rewrite(self, path: Path, data: bytes, at: int) -> None:
        """Write bytes once more, so that the next sync has them to sync."""
        fd = os.open(path, os.O_WRONLY | _AS_IT_IS)
        try:
            os.lseek(fd, at, os.SEEK_SET)
            while data:
                data = data[os.write(fd, data) :]
        finally:
            os.close(fd)

    def sync(self, fd: int) -> None:
        """Make a file's bytes and length durable."""
        if sys.platform == "darwin":  # fsync stops at the drive's own cache
            fcntl.fcntl(fd, fcntl.F_FULLFSYNC)
        elif sys.platform == "win32":
            os.fsync(fd)
        else:
            os.fdatasync(fd)
        _check_writable(fd)

    def cut(self, fd: int, size: int) -> None:
        """Drop everything behind byte `size`."""
        os.ftruncate(fd, size)

    def close(self, fd: int) -> None:
        """Let go of the file."""
        os.close(fd)

    def replace(self, source: Path, target: Path) -> None:
        """Rename a file over another one."""
        source.replace(target)

    def remove(self, path: Path) -> None:
        """Remove a file."""
        path.unlink()

    def sync_folder(self, path: Path) -> None:
        """Make the names in a folder durable; Windows opens no folder."""
        if sys.platform == "win32":
            return
        fd = os.open(path, os.O_RDONLY)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)


def _check_writable(fd: int) -> None:
    """Raise OSError if a file system has turned read-only meanwhile.

    Linux 6.18 ends a sync on ext4 without a word where ext4's own journal was given up under it. To
    set the file's times makes ext4 look at that journal, and then it refuses a write, also of
    nothing. Other versions show it in the file system's flags.
    """
    if sys.platform == "win32":
        return
    with suppress(OSError):  # not every file system takes times
        os.utime(fd)
    os.write(fd, b"")
    if os.fstatvfs(fd).f_flag & os.ST_RDONLY:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))


DISK = Disk()


def write_all(
    files: FileLayer, fd: int, data: bytes | memoryview, *, at_once: int | None = None
) -> None:
    """Append all of `data`, in pieces of `at_once` bytes where that is given."""
    rest = memoryview(data)
    while rest:
        rest = rest[files.write(fd, rest[: at_once or len(rest)]) :]
