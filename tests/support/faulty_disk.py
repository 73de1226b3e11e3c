"""A disk that refuses one change, or every change from one on, and what a session makes of it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from support.accepted_hits import laid_out, missing
from support.recorded_disk import Point, RecordingDisk, power_cuts

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.errors import JournalError, SessionError
from armodal.protocols.os_words import os_words
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal import decode_journal, encode_hit, read_journal
from armodal.protocols.session.records import Session
from armodal.protocols.session.recovery import rebuild

T = TypeVar("T")


class FaultyDisk(RecordingDisk):
    """Refuses change number `at` with `code`, and all later ones too if the fault is `lasting`.

    Half of a write that is refused has reached the file; nothing of anything else has happened.
    """

    def __init__(self, at: int, code: int, *, lasting: bool) -> None:
        super().__init__()
        self._left = at
        self.words = os_words(OSError(code, os.strerror(code)))  # that its refusals say
        self._code = code
        self._lasting = lasting
        self.healthy = False
        self.refused: list[str] = []

    def fail_from_now(self) -> None:
        """Refuse the next change."""
        self._left = 0

    def _try(self, kind: str, change: Callable[[], T]) -> T:
        self._left -= 1
        due = self._left < 0 if self._lasting else self._left == -1
        if due and not self.healthy:
            self.refused.append(kind)
            raise OSError(self._code, os.strerror(self._code))
        return change()

    def create(self, path: Path) -> int:
        return self._try("create", lambda: RecordingDisk.create(self, path))

    def open(self, path: Path) -> int:
        return self._try("open", lambda: RecordingDisk.open(self, path))

    def write(self, fd: int, data: bytes | memoryview) -> int:
        try:
            return self._try("write", lambda: RecordingDisk.write(self, fd, data))
        except OSError:
            if len(self.refused) == 1:
                RecordingDisk.write(self, fd, data[: len(data) // 2])
            raise

    def rewrite(self, path: Path, data: bytes, at: int) -> None:
        self._try("rewrite", lambda: RecordingDisk.rewrite(self, path, data, at))

    def sync(self, fd: int) -> None:
        try:
            self._try("sync", lambda: RecordingDisk.sync(self, fd))
        except OSError:
            self.forgotten(fd)
            raise

    def cut(self, fd: int, size: int) -> None:
        self._try("cut", lambda: RecordingDisk.cut(self, fd, size))

    def replace(self, source: Path, target: Path) -> None:
        self._try("replace", lambda: RecordingDisk.replace(self, source, target))

    def remove(self, path: Path) -> None:
        self._try("remove", lambda: RecordingDisk.remove(self, path))

    def sync_folder(self, path: Path) -> None:
        self._try("folder", lambda: RecordingDisk.sync_folder(self, path))


def _recorded(disk: FaultyDisk, session: Session, path: Path, said: list[str]) -> None:
    """Begin or resume the journal, append the hits it lacks, and derive the session file twice."""
    if path.exists():
        writer, journal = JournalWriter.resume(path, files=disk)
        there = {hit.number for hit in journal.hits}
        disk.announce(*(hit for hit in session.hits if hit.number in there))
    else:
        writer, there = JournalWriter.create(path, session.header, files=disk), set()
    try:
        for hit in session.hits:
            if hit.number not in there:
                writer.append(encode_hit(hit))
                disk.announce(hit)
    finally:
        writer.close()
    for _ in range(2):
        rebuild(path, path.with_suffix(".h5"), software="torture", files=disk)
        said.append("derived")


def wrong_with_faulty_disk(
    session: Session, disk: FaultyDisk, folder: Path, rng: np.random.Generator
) -> str | None:
    """Record a session on a faulty disk, and go on when it is healthy; what is wrong, if anything.

    The fault must be said, no hit announced be lost, then or by a power cut behind it, a session
    file that is there be whole, and the session go on once the disk is as it should be.
    """
    path = folder / "session.journal"
    laid_out({}, folder)
    said: list[str] = []
    try:
        _recorded(disk, session, path, said)
    except (JournalError, SessionError) as error:
        if disk.words not in str(error):
            return f"the fault is not named: {error}"
    else:
        if not disk.refused:
            return None
        if disk.refused != ["remove"]:  # of a file that the next writer removes
            return f"a refused {disk.refused} was not said"
    if said:
        read_session(path.with_suffix(".h5"))
    n_announced = sum(len(change.hits) for change in disk.log)
    disk.healthy = True
    fault_at = len(disk.log)
    if path.exists() and n_announced == 0 and _holds_nothing(path):
        path.unlink()  # as the message says
    _recorded(disk, session, path, said)
    final = read_session(path.with_suffix(".h5"))
    behind = power_cuts(disk.log, rng, each=3, first=max(fault_at - 4, 0))
    wrong = next(filter(None, map(_lost, behind)), None)
    if wrong is not None:
        return f"after a power cut: {wrong}"
    lost = missing({hit.number: hit for hit in session.hits}, final)
    left = sorted(p.name for p in folder.glob(".*"))
    return lost or (f"left behind: {left}" if left else None)


def _holds_nothing(path: Path) -> bool:
    try:
        read_journal(path)
    except JournalError as error:
        return "remove it, and begin the session anew" in str(error)
    return False


def _lost(point: Point) -> str | None:
    """Whether the journal of these files lacks an announced hit."""
    where, files, announced = point
    if not announced:
        return None
    there = {hit.number for hit in decode_journal(files["session.journal"]).hits}
    return next((f"hit {n} is lost {where}" for n in announced if n not in there), None)
