"""Postures from a text file: read, or refused in one sentence."""

from __future__ import annotations

import os

import pytest

from armodal.analyzer.corrected.posture_file import read_postures
from armodal.protocols.errors import ArmError


def read(folder, text):
    path = folder / "path.txt"
    path.write_text(text, encoding="utf-8")
    return read_postures(path, 2)


def test_heads_comments_and_empty_lines_are_passed_over(tmp_path):
    assert read(tmp_path, "j1, j2\n\n1, -2.5 # home\n# away\n3e1,0\n") == [[1.0, -2.5], [30.0, 0.0]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "got 0 postures"),
        ("1,2\n1,2,3\nx,y\n", "line 2: 3 numbers; line 3: 'x,y'"),
        ("1,2\n" * 100_001, "got 100001 postures"),
        ("#\n" * 200_001, "got many more"),
    ],
)
def test_other_lines_are_named(text, words, tmp_path):
    with pytest.raises(ArmError, match="wanted 1 to 100000 lines") as told:
        read(tmp_path, text)
    assert words in str(told.value)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such files")
def test_what_is_no_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.txt")
    with pytest.raises(ArmError, match="wanted a readable file"):
        read_postures(tmp_path / "pipe.txt", 2)
