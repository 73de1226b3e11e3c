"""Whether a journal is still the file that is written, and where its records go if it is not.

A file that is open can lose its name, be replaced, cut or written to by somebody else, and every
write to it still succeeds. So it is looked at before a record counts, and what a session has is
kept until it ends.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from armodal.daq.session_lock import lock_folder
from armodal.protocols.errors import PortError
from armodal.protocols.file_layer import FileLayer, write_all

__all__ = ["rescue", "what_happened_to"]


def what_happened_to(path: Path, fd: int, size: int) -> str:
    """Return what happened to a file that is open and was `size` bytes long; empty if nothing.

    Parameters
    ----------
    path
        Without symbolic links.
    """
    now = os.fstat(fd)
    if now.st_nlink == 0:
        return "was removed"
    try:
        there = path.lstat()
    except OSError:
        return "is no longer where it was"
    if not os.path.samestat(now, there):
        return "was replaced by another file"
    if now.st_size < size:
        return f"was cut from {size} to {now.st_size} bytes by somebody else"
    if now.st_size > size:
        return f"was written to by somebody else, {now.st_size - size} bytes"
    return ""


def rescue(path: Path, records: list[bytes], files: FileLayer) -> Path | None:
    """Write records to a file of their own; return it, None where no folder takes it.

    Beside the journal, else in the folder of the locks on ports.
    """
    folders = [path.parent]
    with suppress(PortError):
        folders.append(lock_folder())
    for folder in folders:
        with suppress(OSError):
            return _written(folder, f"{path.name}.rescue", records, files)
    return None


def _written(folder: Path, name: str, records: list[bytes], files: FileLayer) -> Path:
    number = 1
    while True:
        found = folder / f"{name}-{number}"
        try:
            fd = files.create(found)
            break
        except FileExistsError:
            number += 1
    try:
        for record in records:
            write_all(files, fd, record)
        files.sync(fd)
        files.sync_folder(folder)
    except BaseException:
        with suppress(OSError):
            files.remove(found)
        raise
    finally:
        files.close(fd)
    return found
