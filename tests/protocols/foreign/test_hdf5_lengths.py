"""Lengths that an HDF5 file tells falsely cost no memory: each of them, in files of each kind."""

from __future__ import annotations

import sys

import h5py
import pytest
from support.bombs_of_hdf5 import LONG, lengths_told, with_false_lengths
from support.bounded import wrong_with
from support.foreign_bytes import small_files

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="bounds a process as Linux does"),
    pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning"),
]


@pytest.fixture(scope="module")
def measurements(tmp_path_factory):
    return small_files(tmp_path_factory.mktemp("small"))["a.nc4"]


def test_every_text_of_variable_length_is_found(measurements, tmp_path):
    path = tmp_path / "a.nc4"
    path.write_bytes(measurements)
    with h5py.File(path) as file:
        texts = sum(len(table) for table in file["channels"].values())
    assert len(lengths_told(measurements)) == texts > 0


@pytest.mark.parametrize(
    "length", [LONG // 4, *(pytest.param(n, marks=pytest.mark.long) for n in (LONG, 2**32 - 1))]
)
def test_a_false_length_of_measurements_is_refused_within_bounds(length, measurements, tmp_path):
    path = tmp_path / "a.nc4"
    for data in with_false_lengths(measurements, length):
        path.write_bytes(data)
        assert wrong_with("content", path) == ""
