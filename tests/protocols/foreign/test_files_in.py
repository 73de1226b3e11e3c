"""A folder stands for the files in it."""

import pytest

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.files_in import files_in


def test_a_folder_is_its_files_by_number_without_what_is_hidden(tmp_path):
    for name in ("p10.txt", "p9.txt", "P1.txt", ".keep", "²3.txt"):
        (tmp_path / name).write_text("1 2 3")
    (tmp_path / "within").mkdir()
    alone = tmp_path / "within" / "alone.txt"
    found = files_in([alone, tmp_path])
    assert found[0] == alone  # a file that is not there is told of by its reader
    assert [p.name for p in found[1:]] == ["P1.txt", "p9.txt", "p10.txt", "²3.txt"]


def test_a_folder_without_files_says_what_was_wanted(tmp_path):
    with pytest.raises(ForeignFileError, match="wanted a folder of up to 10000 measured files"):
        files_in([tmp_path])
