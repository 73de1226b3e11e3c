"""What is read is never written over, and a place that takes no file is told before any work."""

from __future__ import annotations

import os

import pytest
from rich.table import Table
from support.command import armodal

from armodal.protocols.errors import SessionError
from armodal.tui.console import out
from armodal.tui.output_file import check_output


@pytest.mark.parametrize("link", [None, os.symlink, os.link])
def test_what_is_read_is_not_written_over_by_whatever_name(tmp_path, link):
    source, other = tmp_path / "s.h5", tmp_path / "other.h5"
    source.write_bytes(b"measured")
    if link is not None:
        link(source, other)
    with pytest.raises(SessionError, match="wanted another file to write than what is read"):
        check_output(source if link is None else other, source)
    check_output(tmp_path / "new.html", source)


def test_a_folder_and_a_file_in_none_are_refused(tmp_path):
    with pytest.raises(SessionError, match="got the folder"):
        check_output(tmp_path)
    with pytest.raises(SessionError, match="there is no folder"):
        check_output(tmp_path / "none" / "report.html")


@pytest.mark.parametrize(
    "arguments",
    [
        ["report", "FILE", "--out", "FILE"],
        ["import", "FILE", "--out", "FILE"],
        ["gap", "FILE", "--html", "FILE"],
        ["export", "FILE", "--out", "FILE"],
        ["export", "FILE", "--out", "new.uff", "--model", "new.txt"],
        ["export", "FILE", "--out", "new.txt", "--model", "new.json"],
        ["report", "FILE", "--out", "none/report.html"],
    ],
)
def test_a_command_that_would_is_one_message_and_changes_nothing(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source = tmp_path / "source.uff"
    source.write_bytes(b"measured")
    said = armodal(*(str(source) if part == "FILE" else part for part in arguments))
    assert said.returncode == 2
    assert said.stderr.count("armodal:") == 1
    assert "wanted" in said.stderr or "cannot write" in said.stderr
    assert [path.name for path in tmp_path.iterdir()] == [source.name]
    assert source.read_bytes() == b"measured"


@pytest.mark.parametrize(
    "command", [["gap", "--lab"], ["gap-study", "--out", "study"], ["sim"], ["demo"], ["run"]]
)
def test_a_negative_seed_is_refused_by_its_name(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = armodal(*command, "--seed", "-1")
    assert said.returncode == 2
    assert "--seed" in said.stderr
    assert list(tmp_path.iterdir()) == []


def test_brackets_in_a_name_are_text_and_a_pipes_lines_are_whole(capsys):
    table = Table("posture")
    table.add_row("a[/b]c [red]")
    out.print(table)
    out.print("/folder" * 40)
    said = capsys.readouterr().out
    assert "a[/b]c [red]" in said
    assert "/folder" * 40 in said
