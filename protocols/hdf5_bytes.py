"""The bytes of an HDF5 file, for what is looked at before HDF5 opens it.

References
----------
HDF5 File Format Specification, version 3.0, II.A "Disk Format: Level 0A - Format Signature and
Superblock": at 0, 512, and twice the place before.
"""

from __future__ import annotations

import mmap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["FileBytes", "mapped", "superblock_at"]

FileBytes = mmap.mmap | bytes

_SIGN = b"\x89HDF\r\n\x1a\n"
_FIRST, _NEXT = 512, 2


@contextmanager
def mapped(path: Path) -> Iterator[FileBytes]:
    """Give the bytes of a file; read as they are asked for.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with path.open("rb") as file:
        if not path.stat().st_size:  # nothing can be mapped of it
            yield b""
            return
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            yield data


def superblock_at(data: FileBytes) -> int | None:
    """Return where the superblock begins, from which addresses count; None if there is none."""
    at = 0
    while at < len(data):
        if data[at : at + len(_SIGN)] == _SIGN:
            return at
        at = at * _NEXT or _FIRST
    return None
