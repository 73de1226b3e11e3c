"""Heaps of an HDF5 file that come to no end are seen before HDF5 goes round in them."""

from __future__ import annotations

import h5py
import pytest

from armodal.protocols.errors import ForeignFileError, SessionError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.hdf5_heap import has_endless_heap
from armodal.protocols.session.hdf5 import read_session

COLLECTION = b"GCOL\x01\0\0\0" + (4096).to_bytes(8, "little")


@pytest.fixture
def file(tmp_path):
    """A file with texts of variable length."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as made:
        made["words"] = ["a", "longer", ""]
    return path


def spoil(path, length):
    """Let what is free in the heap be of another length."""
    data = bytearray(path.read_bytes())
    at = data.index(b"GCOL") + 16
    while int.from_bytes(data[at : at + 2], "little"):  # an object, not what is free
        at += 16 + -(-int.from_bytes(data[at + 8 : at + 16], "little") // 8) * 8
    data[at + 8 : at + 16] = length.to_bytes(8, "little")
    path.write_bytes(data)


def test_a_heap_that_hdf5_wrote_has_an_end(file):
    assert b"GCOL" in file.read_bytes()
    assert not has_endless_heap(file)


@pytest.mark.parametrize("length", [0, 5000, 2**64 - 16, 2**64 - 1])
def test_a_heap_with_a_step_to_nowhere_is_refused_as_measurements_and_as_a_session(file, length):
    spoil(file, length)
    assert has_endless_heap(file)
    with pytest.raises(ForeignFileError, match="cannot be read as one"):
        read_content(file, Hints())
    with pytest.raises(SessionError, match="cannot be read"):
        read_session(file)


@pytest.mark.parametrize("data", [b"", b"GCOL", COLLECTION, COLLECTION + bytes(8)])
def test_a_heap_that_is_cut_off_is_left_to_hdf5(data, tmp_path):
    (tmp_path / "a").write_bytes(data)
    assert not has_endless_heap(tmp_path / "a")
