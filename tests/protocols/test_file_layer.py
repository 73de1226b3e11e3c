"""A sync counts only where the file system still takes what is written."""

from __future__ import annotations

import errno
import os
import sys
from types import SimpleNamespace

import pytest

from armodal.protocols.file_layer import Disk

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no such file systems there")


@pytest.fixture
def written(tmp_path):
    disk = Disk()
    fd = disk.create(tmp_path / "a")
    disk.write(fd, b"a record")
    yield fd
    disk.close(fd)


def test_a_sync_changes_neither_bytes_nor_length(written, tmp_path):
    Disk().sync(written)
    assert (tmp_path / "a").read_bytes() == b"a record"


def test_a_sync_of_a_file_system_that_takes_no_write_any_more_is_refused(written, monkeypatch):
    """As ext4 behaves on Linux 6.18; `bench/torture_block_device.py` tries the real one."""

    def refuse(_fd, _data):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    with monkeypatch.context() as patched:
        patched.setattr(os, "write", refuse)
        with pytest.raises(OSError, match="Read-only"):
            Disk().sync(written)


def test_a_sync_of_a_file_system_that_says_it_is_read_only_is_refused(written, monkeypatch):
    monkeypatch.setattr(os, "fstatvfs", lambda _fd: SimpleNamespace(f_flag=os.ST_RDONLY))
    with pytest.raises(OSError, match="Read-only"):
        Disk().sync(written)


def test_a_file_system_that_takes_no_times_is_written_all_the_same(written, monkeypatch):
    def refuse(_fd):
        raise PermissionError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(os, "utime", refuse)
    Disk().sync(written)
