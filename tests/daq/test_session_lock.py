from __future__ import annotations

import dataclasses
import errno
import fcntl
import json
import os
import pty
import signal
import stat
import subprocess
import sys
import tty
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.fake_session import whole_session

from armodal.daq.holder import Holder, Life, read_holder, this_process
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.serial_port import SerialPort
from armodal.daq.session_lock import SessionLock, lock_folder, lock_journal, lock_port
from armodal.protocols.errors import JournalError, PortError

ROOT = Path(__file__).parents[2]
HOLDS = """
import sys, pathlib
from armodal.daq.session_lock import lock_journal
lock = lock_journal(pathlib.Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def runtime(tmp_path, monkeypatch):
    folder = tmp_path / "runtime"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    return folder


@pytest.fixture
def line():
    master, slave = pty.openpty()
    tty.setraw(slave)
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


@pytest.fixture
def journal(tmp_path):
    return tmp_path / "a.journal"


@pytest.fixture
def other_process(journal):
    """A process that holds the journal until it is killed."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDS.format(root=str(ROOT)), str(journal)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"held\n"
        yield process
        process.kill()


def lock_file(journal: Path) -> Path:
    return journal.with_name(f".{journal.name}.lock")


def left_behind(journal: Path, **changes: object) -> None:
    holder = dataclasses.replace(this_process(), **changes)
    lock_file(journal).write_bytes(holder.encode())


def test_a_living_session_is_named_and_not_disturbed(journal, other_process):
    with pytest.raises(JournalError, match=f"of process {other_process.pid} since 20") as caught:
        lock_journal(journal)
    assert "wait for it to end" in str(caught.value)


def test_the_lock_of_a_killed_session_is_taken_over(journal, other_process):
    other_process.send_signal(signal.SIGKILL)
    other_process.wait()
    assert lock_file(journal).exists()
    lock = lock_journal(journal)
    assert lock.ended is not None
    assert lock.ended.pid == other_process.pid
    lock.release()
    assert not lock_file(journal).exists()


@pytest.mark.parametrize(
    "changes",
    [
        {"pid": 2**22 + 1},  # beyond the numbers Linux gives
        {"started": "1"},  # the number belongs to another process by now
        {"boot_id": "of another boot"},
    ],
)
def test_a_stale_lock_is_told_from_a_living_session(journal, monkeypatch, changes):
    # Where the file system has no locks of its own, the name decides.
    monkeypatch.setattr(fcntl, "flock", no_locks)
    left_behind(journal, **changes)
    lock_journal(journal).release()
    left_behind(journal)
    with pytest.raises(JournalError, match=f"of process {os.getpid()} "):
        lock_journal(journal)


def no_locks(fd: int, operation: int) -> None:
    raise OSError(errno.ENOLCK, "No locks available")


def test_a_session_on_another_machine_is_believed_for_a_journal(journal):
    left_behind(journal, host="other", boot_id="other", pid=4711)
    with pytest.raises(JournalError, match="process 4711 on other") as caught:
        lock_journal(journal)
    assert str(lock_file(journal)) in str(caught.value)


def test_a_lock_that_somebody_just_releases_is_taken_cleanly(journal, monkeypatch):
    first = lock_journal(journal)
    flock, calls = fcntl.flock, []

    def released_meanwhile(fd: int, operation: int) -> None:
        if not calls:
            calls.append(fd)
            first.release()  # after we opened the file, before we locked it
        flock(fd, operation)

    monkeypatch.setattr(fcntl, "flock", released_meanwhile)
    second = lock_journal(journal)
    monkeypatch.undo()
    with pytest.raises(JournalError, match="in use"):
        lock_journal(journal)
    second.release()


@given(
    data=st.binary(max_size=300) | st.builds(lambda v: json.dumps(v).encode(), st.from_type(dict))
)
def test_any_bytes_name_a_holder_or_nobody(data):
    found = read_holder(data)
    assert found is None or isinstance(found, Holder)


def test_a_holder_is_read_back_and_lives():
    holder = this_process()
    assert read_holder(holder.encode()) == holder
    assert holder.life() is Life.LIVING


def test_two_sessions_on_one_port_are_refused_by_whatever_name(line, tmp_path):
    alias = tmp_path / "board"
    alias.symlink_to(line)
    port = SerialPort(line)
    try:
        with pytest.raises(PortError, match=f"in use by another session, of process {os.getpid()}"):
            SerialPort(str(alias))
    finally:
        port.close()
    SerialPort(str(alias)).close()


def test_a_port_that_cannot_be_opened_is_not_held(tmp_path):
    for _ in range(2):
        with pytest.raises(PortError, match="no such device"):
            SerialPort(str(tmp_path / "none"))
    assert list(lock_folder().iterdir()) == []


def test_locks_are_for_their_user_only(journal, runtime):
    locks = [lock_journal(journal), lock_port("/dev/any")]
    for path in (lock_file(journal), *lock_folder().iterdir()):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(lock_folder().stat().st_mode) == 0o700
    for lock in locks:
        lock.release()


def test_a_lock_folder_that_is_open_to_others_is_refused(runtime):
    (runtime / "armodal").mkdir(mode=0o777)
    (runtime / "armodal").chmod(0o777)
    with pytest.raises(PortError, match="of this user alone"):
        lock_port("/dev/any")


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives a folder to somebody else")
def test_a_lock_folder_of_somebody_else_is_refused(runtime):
    (runtime / "armodal").mkdir(mode=0o700)
    os.chown(runtime / "armodal", 65534, -1)
    with pytest.raises(PortError, match="of this user alone"):
        lock_port("/dev/any")
    assert list((runtime / "armodal").iterdir()) == []


def test_a_lock_folder_that_is_a_link_is_refused(runtime, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    (runtime / "armodal").symlink_to(elsewhere, target_is_directory=True)
    with pytest.raises(PortError, match="of this user alone"):
        lock_port("/dev/any")
    assert list(elsewhere.iterdir()) == []


def test_without_a_runtime_folder_the_same_holds_of_that_for_temporary_files(tmp_path, monkeypatch):
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    before = os.umask(0)
    try:
        made = lock_folder()
    finally:
        os.umask(before)
    assert made.parent == tmp_path
    assert stat.S_IMODE(made.stat().st_mode) == 0o700
    made.chmod(0o770)
    with pytest.raises(PortError, match="of this user alone"):
        lock_folder()


def test_a_lock_is_never_followed_to_another_file(journal, tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    lock_file(journal).symlink_to(precious)
    with pytest.raises(OSError, match="symbolic links"):
        SessionLock(lock_file(journal), shared=True)
    assert precious.read_text() == "precious"


def test_journal_and_torn_tail_are_for_their_user_only(lab, fakes):
    before = os.umask(0)
    try:
        whole_session(lab, fakes["record"]())
        with lab.journal.open("ab") as file:
            file.write(b"half a record")
        writer, _ = JournalWriter.resume(lab.journal)
        writer.close()
    finally:
        os.umask(before)
    files = [p for p in lab.journal.parent.iterdir() if p.is_file()]
    assert len(files) == 2
    for path in files:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600, path


def test_a_second_session_ends_with_one_message_and_exit_code_2(lab, fakes):
    held = SerialPort(lab.board.name)
    try:
        end, code = whole_session(lab, fakes["record"]())
    finally:
        held.close()
    assert code == 2
    assert end.kind == "PortError"
    assert "in use by another session" in end.message
    assert not lab.journal.exists()
