"""A journal that somebody takes away, replaces, cuts or writes to while it is written."""

from __future__ import annotations

import os
import shutil

import numpy as np
import pytest
from support.quick import every_nth

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal import Mark, MarkKind, encode_mark, read_journal


@pytest.fixture(autouse=True)
def runtime(tmp_path, monkeypatch):
    folder = tmp_path / "runtime"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    return folder / "armodal"


@pytest.fixture
def path(tmp_path):
    folder = tmp_path / "data"
    folder.mkdir()
    return folder / "a.journal"


def mark(note: str) -> bytes:
    return encode_mark(Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=1.0, note=note))


def notes(path) -> list[str]:
    return [m.note for m in read_journal(path).marks]


def removed(path):
    path.unlink()


def moved(path):
    path.rename(path.with_name("elsewhere"))


def replaced(path):
    path.with_name("other").write_bytes(path.read_bytes())
    path.with_name("other").replace(path)


def cut(path):
    os.truncate(path, path.stat().st_size // 2)


def written_to(path):
    with path.open("ab") as file:
        file.write(b"not ours")


def folder_removed(path):
    shutil.rmtree(path.parent)


ATTACKS = (removed, moved, replaced, cut, written_to, folder_removed)


@pytest.mark.parametrize("attack", ATTACKS)
def test_what_counted_is_rescued_and_nothing_more_counts(header, path, runtime, attack):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    writer.append(mark("two"))
    attack(path)
    with pytest.raises(JournalError, match="THE JOURNAL") as caught:
        writer.append(mark("three"))
    with pytest.raises(JournalError, match="takes no more records"):
        writer.append(mark("four"))
    writer.close()
    saved = (runtime if attack is folder_removed else path.parent) / "a.journal.rescue-1"
    assert str(saved) in str(caught.value)
    again, journal = JournalWriter.resume(saved)
    again.close()
    assert [m.note for m in journal.marks] == ["one", "two"]


def test_a_second_rescue_leaves_the_first(header, path):
    for note in ("first", "second"):
        writer = JournalWriter.create(path, header)
        writer.append(mark(note))
        path.unlink()
        with pytest.raises(JournalError):
            writer.append(mark("in hand"))
        writer.close()
    found = [notes(path.with_name(f"a.journal.rescue-{n}")) for n in (1, 2)]
    assert found == [["first"], ["second"]]


def test_a_rescue_never_follows_a_link_that_somebody_laid(header, path, tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    path.with_name("a.journal.rescue-1").symlink_to(precious)
    path.with_name("a.journal.rescue-2").symlink_to(tmp_path / "not there")
    writer = JournalWriter.create(path, header)
    writer.append(mark("kept"))
    removed(path)
    before = os.umask(0)
    try:
        with pytest.raises(JournalError, match="rescue-3"):
            writer.append(mark("too late"))
    finally:
        os.umask(before)
    rescued = path.with_name("a.journal.rescue-3")
    assert notes(rescued) == ["kept"]
    assert rescued.stat().st_mode & 0o077 == 0
    assert precious.read_text() == "precious"
    assert not (tmp_path / "not there").exists()


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_another_name_of_a_journal_in_use_is_in_use(header, path, link):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    other = path.with_name("other.journal")
    link(path, other)
    with pytest.raises(JournalError, match="in use by"):
        JournalWriter.resume(other)
    writer.append(mark("two"))
    writer.close()
    assert notes(other) == ["one", "two"]


def test_a_link_to_a_journal_resumes_it(header, path):
    JournalWriter.create(path, header).close()
    link = path.with_name("link")
    link.symlink_to(path)
    writer, _ = JournalWriter.resume(link)
    writer.append(mark("one"))
    writer.close()
    assert notes(path) == ["one"]


@pytest.mark.parametrize("seed", every_nth(range(40), 4))
def test_nothing_announced_is_lost_whenever_it_happens(header, path, runtime, seed):
    """Announced: `append` returned. A resumed session goes on in what was rescued."""
    rng = np.random.default_rng(seed)
    announced: list[str] = []
    writer = JournalWriter.create(path, header)
    for number in range(12):
        if rng.random() < 0.3 and writer.path.exists():
            ATTACKS[rng.integers(len(ATTACKS))](writer.path)
        try:
            writer.append(mark(str(number)))
        except JournalError as error:
            saved = str(error).partition("is safe in ")[2].partition(": resume")[0]
            writer.close()
            writer, journal = JournalWriter.resume(type(path)(saved))
            assert [m.note for m in journal.marks] == announced
        else:
            announced.append(str(number))
    writer.close()
    assert notes(writer.path) == announced
