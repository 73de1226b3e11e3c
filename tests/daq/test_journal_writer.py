from __future__ import annotations

import os

import pytest

from armodal.daq.journal_writer import LAST_BYTES, LAST_RECORDS, JournalWriter
from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal import (
    End,
    Mark,
    MarkKind,
    encode_end,
    encode_mark,
    encode_record,
    read_journal,
    scan,
)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.journal"


def mark(note: str) -> bytes:
    return encode_mark(Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=1.0, note=note))


def notes(path) -> list[str]:
    return [m.note for m in read_journal(path).marks]


def test_what_was_appended_is_there_while_the_file_is_still_open(header, path):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    assert notes(path) == ["one"]
    assert writer.last_commit_s > 0.0
    writer.close()


def test_append_returns_only_after_the_record_is_durable(header, path, monkeypatch):
    writer = JournalWriter.create(path, header)
    synced: list[int] = []
    sync = os.fdatasync
    monkeypatch.setattr(
        "armodal.protocols.file_layer.os.fdatasync",
        lambda fd: (synced.append(os.fstat(fd).st_size), sync(fd))[1],
    )
    writer.append(mark("one"))
    assert synced == [path.stat().st_size]
    writer.close()


def test_an_existing_file_is_never_begun_again(header, path):
    path.write_bytes(b"precious")
    with pytest.raises(JournalError, match="exists already"):
        JournalWriter.create(path, header)
    assert path.read_bytes() == b"precious"


@pytest.mark.parametrize("resume", [True, False])
def test_a_second_writer_is_locked_out(header, path, resume):
    writer = JournalWriter.create(path, header)
    try:
        with pytest.raises(JournalError, match="in use by another session"):
            JournalWriter.resume(path) if resume else JournalWriter.create(path, header)
    finally:
        writer.close()


@pytest.mark.parametrize("kept", [1, 7, 12, 40])
def test_a_torn_tail_is_set_aside_and_complete_records_stay(header, path, kept):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    writer.append(mark("two"))
    writer.close()
    torn = mark("three")[:kept]
    with path.open("ab") as file:
        file.write(torn)
    writer, journal = JournalWriter.resume(path)
    assert [m.note for m in journal.marks] == ["one", "two"]
    writer.append(mark("four"))
    writer.close()
    assert notes(path) == ["one", "two", "four"]
    assert path.with_name("a.journal.torn-1").read_bytes() == torn
    assert read_journal(path).dropped_bytes == 0


def test_records_behind_damage_are_not_thrown_away(header, path):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    size = path.stat().st_size
    writer.append(mark("two"))
    writer.close()
    data = bytearray(path.read_bytes())
    data[size - 10] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(JournalError, match="complete records behind"):
        JournalWriter.resume(path)
    assert path.read_bytes() == data


def test_a_full_disk_is_said_and_the_record_does_not_count(header, path, monkeypatch):
    writer = JournalWriter.create(path, header)

    def full(fd: int, data: memoryview) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("armodal.protocols.file_layer.os.write", full)
    with pytest.raises(JournalError, match="no space is left"):
        writer.append(mark("one"))
    monkeypatch.undo()
    writer.close()
    assert notes(path) == []


def test_a_record_torn_by_a_full_disk_is_cut_off_and_nothing_follows_it(header, path, monkeypatch):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    good = path.read_bytes()
    write, calls = os.write, []

    def fills_up(fd: int, data: memoryview) -> int:
        calls.append(fd)
        if len(calls) > 1:
            raise OSError(28, "No space left on device")
        return write(fd, data[:5])

    monkeypatch.setattr("armodal.protocols.file_layer.os.write", fills_up)
    with pytest.raises(JournalError, match="no space is left"):
        writer.append(mark("two"))
    monkeypatch.undo()
    assert path.read_bytes() == good
    with pytest.raises(JournalError, match="takes no more records"):
        writer.append(mark("three"))
    writer.close()
    assert notes(path) == ["one"]


def refusal(writer: JournalWriter, record: bytes) -> str:
    try:
        writer.append(record)
    except JournalError as error:
        return str(error)
    return ""


def filled(writer: JournalWriter, record: bytes) -> int:
    """Append until it is refused; return how many were taken."""
    refusals = (refusal(writer, record) for _ in range(1000))
    taken, said = next((n, said) for n, said in enumerate(refusals) if said)
    assert "is full" in said
    return taken


def test_a_journal_with_as_many_records_as_a_reader_takes_can_still_be_ended_and_read(
    header, path, monkeypatch
):
    most = 3 * LAST_RECORDS
    for module in ("armodal.daq.journal_writer", "armodal.protocols.session.journal_framing"):
        monkeypatch.setattr(f"{module}.MAX_RECORDS", most)
    JournalWriter.create(path, header).close()
    before = 5
    with path.open("ab") as file:
        # Of a kind that readers pass over, the header being the one more.
        file.write(encode_record(99, b"") * (most - LAST_RECORDS - before - 1))
    writer, _ = JournalWriter.resume(path)
    assert filled(writer, mark("one")) == before
    writer.begin_ending()
    assert filled(writer, encode_end(End(reason="full", host_s=2.0))) == LAST_RECORDS
    writer.close()
    journal = read_journal(path)
    assert len(journal.marks) == before
    assert journal.end == End(reason="full", host_s=2.0)
    assert len(scan(path.read_bytes()).records) == most


def test_a_journal_as_long_as_a_reader_takes_can_still_be_ended_and_read(header, path, monkeypatch):
    writer = JournalWriter.create(path, header)
    most = path.stat().st_size + LAST_BYTES + 5 * len(mark("one")) + 7
    for module in ("armodal.daq.journal_writer", "armodal.protocols.session.journal_bytes"):
        monkeypatch.setattr(f"{module}.MAX_JOURNAL", most)
    assert filled(writer, mark("one")) == 5
    writer.begin_ending()
    longest = encode_end(End(reason="\x01" * 4096, host_s=2.0))
    assert filled(writer, longest) == (LAST_BYTES + 7) // len(longest) >= LAST_RECORDS
    writer.close()
    assert most - len(longest) < path.stat().st_size <= most
    assert len(notes(path)) == 5


def test_a_full_journal_is_not_gone_on_with_and_stays_as_it_is(header, path, monkeypatch):
    writer = JournalWriter.create(path, header)
    writer.append(mark("one"))
    writer.close()
    before = path.read_bytes()
    monkeypatch.setattr("armodal.daq.journal_writer.MAX_RECORDS", LAST_RECORDS + 2)
    writer, _ = JournalWriter.resume(path)
    assert filled(writer, mark("two")) == 0
    writer.close()
    assert path.read_bytes() == before


def test_a_path_that_cannot_be_is_one_sentence(header, tmp_path):
    with pytest.raises(JournalError, match="cannot begin the journal"):
        JournalWriter.create(tmp_path / "no" / "such" / "folder", header)
    with pytest.raises(JournalError, match="cannot resume the journal"):
        JournalWriter.resume(tmp_path / "nothing.journal")
