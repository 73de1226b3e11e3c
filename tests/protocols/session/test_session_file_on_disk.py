import os
import stat
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from armodal.protocols.errors import SessionError
from armodal.protocols.file_layer import Disk
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.hdf5 import read_session, write_session


class Noting(Disk):
    """The real disk, with the order of what is done to it."""

    def __init__(self) -> None:
        self.done: list[str] = []

    def sync(self, fd: int) -> None:
        self.done.append("sync")
        super().sync(fd)

    def replace(self, source: Path, target: Path) -> None:
        self.done.append("replace")
        super().replace(source, target)

    def sync_folder(self, path: Path) -> None:
        self.done.append("sync folder")
        super().sync_folder(path)


def test_the_file_is_durable_before_it_takes_its_name_and_the_name_after(example, tmp_path):
    disk = Noting()
    write_session(example.session, tmp_path / "a.h5", files=disk)
    assert disk.done == ["sync", "replace", "sync folder"]


def test_the_session_file_is_for_its_user_only_whatever_the_umask(example, tmp_path):
    before = os.umask(0)
    try:
        write_session(example.session, tmp_path / "a.h5")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.h5").stat().st_mode) == 0o600


def test_what_a_killed_writer_left_is_removed_and_a_living_one_s_file_is_not(example, tmp_path):
    with subprocess.Popen([sys.executable, "-c", ""]) as ended:
        ended.wait()
    left = tmp_path / f".a.h5.{ended.pid}.part"
    others = [tmp_path / f".a.h5.{os.getppid()}.part", tmp_path / ".a.h5.notes.part"]
    for path in (left, *others):
        path.write_bytes(b"half")
    write_session(example.session, tmp_path / "a.h5")
    assert not left.exists()
    assert all(path.exists() for path in others)


@pytest.mark.parametrize("number", [0, 2**31])  # of a group of processes; more than there may be
def test_what_is_left_under_a_number_no_process_has_is_removed(example, tmp_path, number):
    left = tmp_path / f".a.h5.{number}.part"
    left.write_bytes(b"half")
    write_session(example.session, tmp_path / "a.h5")
    assert not left.exists()


def test_what_another_user_s_process_is_writing_is_left(example, tmp_path, monkeypatch):
    def refuse(_pid: int, _signal: int) -> None:
        raise PermissionError(1, "Operation not permitted")

    theirs = tmp_path / f".a.h5.{os.getppid()}.part"
    theirs.write_bytes(b"half")
    monkeypatch.setattr("os.kill", refuse)
    write_session(example.session, tmp_path / "a.h5")
    assert theirs.exists()


def test_a_link_where_the_temporary_file_should_be_is_not_followed(example, tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    (tmp_path / f".a.h5.{os.getpid()}.part").symlink_to(precious)
    write_session(example.session, tmp_path / "a.h5")
    assert precious.read_text() == "precious"
    assert first_difference(read_session(tmp_path / "a.h5"), example.session, "session") is None


def test_a_disk_that_is_full_keeps_the_old_file_and_leaves_nothing_else(example, tmp_path):
    class Full(Disk):
        def write(self, fd: int, data: bytes | memoryview) -> int:
            raise OSError(28, "No space left on device")

    path = tmp_path / "a.h5"
    write_session(example.session, path)
    before = path.read_bytes()
    with pytest.raises(SessionError, match=r"no space is left.*armodal recover"):
        write_session(example.session, path, files=Full())
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("sign", [0, 2, -128])
def test_a_polarity_that_is_none_is_refused(example, tmp_path: Path, sign: int) -> None:
    write_session(example.session, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        found: list[str] = []
        file.visit(lambda name: found.append(name) if name.endswith("polarity") else None)
        file[found[0]][0] = sign
    with pytest.raises(SessionError, match=r"polarity.*wanted 1 and -1"):
        read_session(tmp_path / "a.h5")
