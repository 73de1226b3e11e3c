"""Folders of laboratories that were killed are cleaned up by the next one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile

from armodal.hil_sim.temporary import new_lab_folder


def pid_that_has_gone() -> int:
    """The number of a process that was waited for."""
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        pass
    return process.pid


def test_what_a_killed_process_left_is_removed_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    gone = pid_that_has_gone()
    left = tmp_path / f"armodal-lab-{gone}-left"
    (left / "inside").mkdir(parents=True)
    elsewhere = tmp_path / "data"
    elsewhere.mkdir()
    kept = [
        tmp_path / f"armodal-lab-{os.getpid()}-mine",  # its process runs
        tmp_path / "armodal-lab-notes-of-mine",
        tmp_path / f"armodal-lab-{10**30}-no-process",
    ]
    for folder in kept:
        folder.mkdir()
    link = tmp_path / f"armodal-lab-{gone}-link"
    link.symlink_to(elsewhere, target_is_directory=True)
    made = new_lab_folder()
    assert not left.exists()
    assert elsewhere.is_dir()
    assert sorted(tmp_path.iterdir()) == sorted([*kept, elsewhere, link, made])


def test_a_new_folder_tells_its_process_and_is_for_nobody_else(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    before = os.umask(0)
    try:
        made = new_lab_folder()
    finally:
        os.umask(before)
    assert made.name.startswith(f"armodal-lab-{os.getpid()}-")
    assert made.stat().st_mode & 0o077 == 0
