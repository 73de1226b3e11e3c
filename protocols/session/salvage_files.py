"""What salvage took of a damaged journal, written as journals and session files of their own."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from armodal.protocols.errors import SessionError
from armodal.protocols.file_layer import DISK, FileLayer, write_all
from armodal.protocols.os_words import os_words
from armodal.protocols.session.journal import read_journal
from armodal.protocols.session.journal_bytes import journal_file
from armodal.protocols.session.recovery import FrfEstimator, Recovery, rebuild
from armodal.protocols.session.salvage import Salvage, SalvagedSession, salvage

__all__ = ["SalvagedFile", "rebuild_salvaged"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SalvagedFile:
    """A session that was salvaged: its journal, its session file and what they hold."""

    journal: Path
    session_file: Path
    salvaged: SalvagedSession
    recovery: Recovery


def rebuild_salvaged(
    journal_path: Path,
    *,
    software: str,
    header_of: Path | None = None,
    estimate_frfs: FrfEstimator | None = None,
    files: FileLayer = DISK,
) -> tuple[Salvage, tuple[SalvagedFile, ...]]:
    """Write a journal and a session file for each session of which a damaged journal has records.

    They lie beside it, `NAME.salvaged-1.journal` and so on; none that is there is replaced. The
    damaged journal is never changed.

    Parameters
    ----------
    header_of
        Another journal of the same arm and plan, for one that lost its HEADER.

    Raises
    ------
    JournalError, SessionError
        If nothing can be taken; if a file cannot be read or written.
    """
    header = None if header_of is None else read_journal(header_of).header
    with journal_file(journal_path) as data:
        found = salvage(data, header=header)
        paths = [_written(journal_path, session, files) for session in found.sessions]
    return found, tuple(
        SalvagedFile(
            journal=path,
            session_file=path.with_suffix(".h5"),
            salvaged=session,
            recovery=rebuild(
                path,
                path.with_suffix(".h5"),
                software=software,
                estimate_frfs=estimate_frfs,
                files=files,
            ),
        )
        for session, path in zip(found.sessions, paths, strict=True)
    )


def _written(journal: Path, session: SalvagedSession, files: FileLayer) -> Path:
    """Write a session's journal under the next free name, whole or not at all."""
    number = 1
    while (path := _name(journal, number)).exists() or path.with_suffix(".h5").exists():
        number += 1
    try:
        fd = files.create(path)
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        for part in session.parts():
            write_all(files, fd, part)
        files.sync(fd)
        files.sync_folder(path.parent)
    except BaseException as error:
        with suppress(OSError):
            files.remove(path)
        if isinstance(error, OSError):
            raise _cannot_write(path, error) from error
        raise
    finally:
        files.close(fd)
    return path


def _name(journal: Path, number: int) -> Path:
    return journal.with_name(f"{journal.stem}.salvaged-{number}.journal")


def _cannot_write(path: Path, error: OSError) -> SessionError:
    return SessionError(
        f"cannot write {path}: {os_words(error)}; check rights and free space, or copy the damaged "
        "journal where there is room and salvage the copy"
    )
