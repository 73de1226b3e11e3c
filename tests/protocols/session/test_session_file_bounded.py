"""What a session file tells falsely costs no memory: lengths, parts, chunks."""

from __future__ import annotations

import sys
from itertools import islice

import h5py
import pytest
from support.bombs_of_hdf5 import with_a_virtual, with_false_lengths
from support.bounded import wrong_with

from armodal.protocols.errors import SessionError
from armodal.protocols.session.hdf5 import read_session

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="bounds a process as Linux does"),
    pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning"),
]

EACH = 24  # of the lengths; `bench/torture_bounds.py` tries them all


def test_attributes_told_falsely_are_never_read(written_bytes, tmp_path):
    path = tmp_path / "a.h5"
    tried = 0
    for data in islice(with_false_lengths(written_bytes), 0, None, EACH):
        path.write_bytes(data)
        assert wrong_with("session", path) == ""
        read_session(path)  # they are for viewers
        tried += 1
    assert tried > 0


def test_a_text_of_variable_length_is_refused_unread(written_bytes, tmp_path):
    path = tmp_path / "a.h5"
    path.write_bytes(written_bytes)
    with h5py.File(path, "a") as file:
        del file["session/warnings"]
        file.create_dataset("session/warnings", (1,), h5py.string_dtype())[0] = "a warning"
    for data in islice(with_false_lengths(path.read_bytes()), 0, None, EACH):
        path.write_bytes(data)
        assert wrong_with("session", path) == ""
        with pytest.raises(SessionError, match="fixed-length strings"):
            read_session(path)


@pytest.mark.parametrize("entries", [2**20, 2**24, 2**28, 2**60])
def test_parts_of_a_virtual_dataset_that_are_not_there_take_nothing(
    entries, written_bytes, tmp_path
):
    path = tmp_path / "a.h5"
    path.write_bytes(with_a_virtual(written_bytes, "session/warnings", (2,), entries))
    assert wrong_with("session", path) == ""
    with pytest.raises(SessionError, match="data in another file"):
        read_session(path)


@pytest.mark.parametrize(
    ("rows", "read"),
    [(8, True), (2**24, False), pytest.param(2**26, False, marks=pytest.mark.long)],
)
def test_a_chunk_far_larger_than_its_data_is_not_unpacked(rows, read, written_bytes, tmp_path):
    path = tmp_path / "a.h5"
    path.write_bytes(written_bytes)
    with h5py.File(path, "a") as file:
        del file["session/warnings"]
        warnings = file.create_dataset(
            "session/warnings", (1,), "S10", chunks=(rows,), maxshape=(None,), compression="gzip"
        )
        warnings[0] = b"a warning"
    assert wrong_with("session", path) == ""
    if read:
        assert read_session(path).warnings == ("a warning",)
    else:
        with pytest.raises(SessionError, match="cannot be read"):
            read_session(path)
