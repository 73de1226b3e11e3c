"""Texts of variable length in HDF5 files are held to the bounds of numbers."""

from __future__ import annotations

import h5py
import pytest

from armodal.protocols.foreign.hdf5_variables import hdf5_variables


@pytest.mark.parametrize(("chunk", "read"), [(None, True), (8, True), (2**23, False)])
def test_texts_in_a_chunk_beyond_what_the_file_may_become_are_not_read(chunk, read, tmp_path):
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        made = file.create_dataset(
            "words", (3,), h5py.string_dtype(), chunks=chunk and (chunk,),
            maxshape=chunk and (None,), compression=chunk and "gzip",
        )  # fmt: skip
        made[:] = ["x", "y", "z"]
    (part,) = hdf5_variables(path)
    assert part.texts.get("words") == (("x", "y", "z") if read else None)
    assert ("words" in [one.name for one in part.others]) != read
