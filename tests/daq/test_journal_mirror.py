"""A journal kept twice: what counted is on both disks, whichever of them fails or goes."""

from __future__ import annotations

import os
import shutil

import numpy as np
import pytest
from support.quick import every_nth

from armodal.daq.journal_mirror import begin, go_on, on_one_disk
from armodal.protocols.errors import JournalError
from armodal.protocols.file_layer import Disk
from armodal.protocols.session.journal import Mark, MarkKind, encode_mark, read_journal


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.journal"


@pytest.fixture
def mirror(tmp_path):
    folder = tmp_path / "other"
    folder.mkdir()
    return folder


def mark(note: str) -> bytes:
    return encode_mark(Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=1.0, note=note))


def notes(path) -> list[str]:
    return [m.note for m in read_journal(path).marks]


class Refusing(Disk):
    """A disk that takes no write to files in one folder, from a certain one on."""

    def __init__(self, folder, after: int) -> None:
        self._folder = folder
        self._left = after
        self._fds: set[int] = set()

    def create(self, path):
        fd = super().create(path)
        if path.parent == self._folder:
            self._fds.add(fd)
        return fd

    def write(self, fd, data):
        if fd in self._fds:
            if self._left == 0:
                super().write(fd, data[: len(data) // 2])
                raise OSError(28, "No space left on device")
            self._left -= 1
        return super().write(fd, data)


def test_both_files_hold_every_record(header, path, mirror):
    writer = begin(path, header, mirror=mirror)
    assert writer.append(mark("one")) == writer.last_commit_s > 0
    writer.close()
    assert path.read_bytes() == (mirror / "a.journal").read_bytes()
    assert (mirror / "a.journal").stat().st_mode & 0o777 == 0o600
    assert notes(path) == ["one"]


@pytest.mark.parametrize("which", ["journal", "mirror"])
def test_a_record_that_one_disk_refuses_is_on_neither(header, path, mirror, which):
    folder = path.parent if which == "journal" else mirror
    writer = begin(path, header, mirror=mirror, files=Refusing(folder, 2))
    writer.append(mark("one"))
    with pytest.raises(JournalError, match="no space is left") as caught:
        writer.append(mark("two"))
    assert ("the mirror" in str(caught.value)) == (which == "mirror")
    with pytest.raises(JournalError, match="takes no more records"):
        writer.append(mark("three"))
    writer.close()
    assert notes(path) == notes(mirror / "a.journal") == ["one"]


@pytest.mark.parametrize("lost", ["journal", "mirror"])
def test_one_that_is_gone_is_made_of_the_other(header, path, mirror, lost):
    writer = begin(path, header, mirror=mirror)
    writer.append(mark("one"))
    writer.close()
    (path if lost == "journal" else mirror / "a.journal").unlink()
    writer, journal = go_on(path, mirror=mirror)
    assert [m.note for m in journal.marks] == ["one"]
    writer.append(mark("two"))
    writer.close()
    assert notes(path) == notes(mirror / "a.journal") == ["one", "two"]


@pytest.mark.parametrize("shorter", ["journal", "mirror"])
@pytest.mark.parametrize("torn", [0, 5])
def test_the_shorter_one_gets_what_the_other_has(header, path, mirror, shorter, torn):
    writer = begin(path, header, mirror=mirror)
    for note in ("one", "two", "three"):
        writer.append(mark(note))
    writer.close()
    cut = path if shorter == "journal" else mirror / "a.journal"
    os.truncate(cut, cut.stat().st_size - len(mark("two") + mark("three")) + torn)
    writer, journal = go_on(path, mirror=mirror)
    writer.close()
    assert [m.note for m in journal.marks] == ["one", "two", "three"]
    assert path.read_bytes() == (mirror / "a.journal").read_bytes()


def test_another_session_is_no_mirror(header, path, mirror):
    for where, note in ((path, "one"), (mirror / "a.journal", "other")):
        writer = begin(where, header, mirror=None)
        writer.append(mark(note))
        writer.close()
    with pytest.raises(JournalError, match="different sessions"):
        go_on(path, mirror=mirror)
    writer, _ = go_on(path, mirror=None)  # nothing holds it any more
    writer.close()


def test_the_journals_own_folder_and_no_folder_are_no_mirrors(header, path, tmp_path):
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(JournalError, match=r"--mirror .* folder"):
            begin(path, header, mirror=folder)
    assert not path.exists()
    assert on_one_disk(path, tmp_path)


def test_a_journal_that_is_there_is_not_begun_and_leaves_no_mirror(header, path, mirror):
    path.write_bytes(b"precious")
    with pytest.raises(JournalError, match="exists already"):
        begin(path, header, mirror=mirror)
    assert list(mirror.iterdir()) == []


@pytest.mark.parametrize("seed", every_nth(range(30), 4))
def test_no_announced_record_is_lost_with_either_disk(header, path, mirror, seed):
    """One of the two is taken away, replaced, cut or written to; the other has all."""
    rng = np.random.default_rng(seed)
    writer = begin(path, header, mirror=mirror)
    announced = []
    when, which = int(rng.integers(1, 8)), int(rng.integers(2))
    target = (path, mirror / "a.journal")[which]
    attacks = (
        target.unlink,
        lambda: os.truncate(target, int(rng.integers(target.stat().st_size))),
        lambda: target.write_bytes(b"other"),
        lambda: (
            shutil.copy(target, target.with_name("b")) and target.with_name("b").replace(target)
        ),
    )
    for number in range(8):
        if number == when:
            attacks[rng.integers(len(attacks))]()
        try:
            writer.append(mark(str(number)))
        except JournalError:
            break
        announced.append(str(number))
    writer.close()
    assert len(announced) == when
    other = (path, mirror / "a.journal")[1 - which]
    assert notes(other) == announced
