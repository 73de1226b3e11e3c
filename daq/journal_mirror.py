"""A journal kept twice, on two disks: a record counts once it is durable on both."""

from __future__ import annotations

from pathlib import Path

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.errors import JournalError
from armodal.protocols.file_layer import DISK, FileLayer, write_all
from armodal.protocols.os_words import os_words
from armodal.protocols.session.journal import Journal, decode_journal, read_journal, scan
from armodal.protocols.session.records import SessionHeader

__all__ = ["MirroredJournal", "begin", "go_on", "on_one_disk"]


class MirroredJournal:
    """Two journal writers that take every record together; made by `begin` or `go_on`.

    Attributes
    ----------
    path : Path
        The journal; its mirror has the same name in another folder.
    last_commit_s : float
        Wall seconds the last `append` took, both disks together.
    """

    def __init__(self, ours: JournalWriter, mirror: JournalWriter) -> None:
        self.path = ours.path
        self.last_commit_s = 0.0
        self._ours = ours
        self._mirror = mirror

    def append(self, record: bytes) -> float:
        """Append a record to both files; return, once it is durable in both, the wall seconds.

        Raises
        ------
        JournalError
            If either cannot take it. Neither holds it then, and neither takes another.
        """
        try:
            mirror_s = self._mirror.append(record)
        except JournalError as error:
            self._ours.end_here()
            raise JournalError(f"the mirror: {error}") from error
        try:
            self.last_commit_s = mirror_s + self._ours.append(record)
        except JournalError:
            self._mirror.take_back()
            raise
        return self.last_commit_s

    def begin_ending(self) -> None:
        """Let the records that follow take the room kept for a session's last ones."""
        self._ours.begin_ending()
        self._mirror.begin_ending()

    def close(self) -> None:
        """Close both files."""
        self._ours.close()
        self._mirror.close()


def begin(
    path: Path, header: SessionHeader, *, mirror: Path | None, files: FileLayer = DISK
) -> JournalWriter | MirroredJournal:
    """Begin a journal, and its mirror where a folder is given; errors as `JournalWriter.create`."""
    if mirror is None:
        return JournalWriter.create(path, header, files=files)
    other = JournalWriter.create(_mirror_of(path, mirror), header, files=files)
    try:
        return MirroredJournal(JournalWriter.create(path, header, files=files), other)
    except BaseException:
        other.close()
        files.remove(other.path)
        raise


def go_on(
    path: Path, *, mirror: Path | None, files: FileLayer = DISK
) -> tuple[JournalWriter | MirroredJournal, Journal]:
    """Open a journal to go on with it, and its mirror where a folder is given.

    Of the two the shorter one is made as long as the other: one may hold a record more that never
    counted, or have lost what its disk lost. A mirror that is not there is made.

    Raises
    ------
    JournalError
        As `JournalWriter.resume`, of either; and if the two tell of different sessions.
    """
    if mirror is None:
        return JournalWriter.resume(path, files=files)
    copy = _mirror_of(path, mirror)
    _make_missing(path, copy, files)
    ours, journal = JournalWriter.resume(path, files=files)
    try:
        other, _ = JournalWriter.resume(copy, files=files)
    except BaseException:
        ours.close()
        raise
    both = MirroredJournal(ours, other)
    try:
        return both, _evened(ours, other, journal)
    except BaseException:
        both.close()
        raise


def on_one_disk(path: Path, mirror: Path) -> bool:
    """Return whether a journal and its mirror would lie in one file system."""
    try:
        return path.resolve().parent.stat().st_dev == mirror.stat().st_dev
    except OSError:
        return False


def _mirror_of(path: Path, mirror: Path) -> Path:
    if not mirror.is_dir():
        raise JournalError(f"--mirror {mirror}: wanted a folder on another disk; make it first")
    if mirror.resolve() == path.resolve().parent:
        raise JournalError(
            f"--mirror {mirror}: wanted another folder than the journal's own; give one on another "
            "disk"
        )
    return mirror / path.name


def _make_missing(path: Path, copy: Path, files: FileLayer) -> None:
    """Copy the one that is there to where the other is missing."""
    for source, target in ((path, copy), (copy, path)):
        if source.exists() and not target.exists():
            whole = source.read_bytes()[: read_journal(source).good_end]
            try:
                fd = files.create(target)
                try:
                    write_all(files, fd, whole)
                    files.sync(fd)
                    files.sync_folder(target.parent)
                finally:
                    files.close(fd)
            except OSError as error:
                raise JournalError(
                    f"cannot copy the journal {source} to {target}: {os_words(error)}; check "
                    "rights and free space"
                ) from error


def _evened(ours: JournalWriter, other: JournalWriter, journal: Journal) -> Journal:
    """Make both hold the same; return what that is."""
    one, two = ours.held(), other.held()
    if not (one.startswith(two) or two.startswith(one)):
        raise JournalError(
            f"{ours.path} and its mirror {other.path} tell of different sessions, or are damaged: "
            "give another --mirror, and take what is whole of both with armodal recover --salvage"
        )
    shorter, longest = (ours, two) if len(one) < len(two) else (other, one)
    have = len(shorter.held())
    for record in scan(longest).records:
        if record.offset >= have:
            shorter.append(bytes(record.whole))
    return journal if shorter is other else decode_journal(longest)
