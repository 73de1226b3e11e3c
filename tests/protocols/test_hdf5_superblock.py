"""An HDF5 file of several parts is refused before HDF5 makes room for its driver's block."""

from __future__ import annotations

import h5py
import pytest
from support.bombs import of_a_driver

from armodal.protocols.errors import ForeignFileError, SessionError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.hdf5_superblock import names_a_driver
from armodal.protocols.session.hdf5 import read_session


@pytest.mark.parametrize("userblock", [0, 512, 2048])
@pytest.mark.parametrize("library", ["earliest", "v108", "v110"])
def test_a_file_that_is_whole_names_no_driver(userblock, library, tmp_path):
    with h5py.File(
        tmp_path / "a.h5", "w", userblock_size=userblock, libver=(library, "v110")
    ) as file:
        file["a"] = [1.0, 2.0]
    assert not names_a_driver(tmp_path / "a.h5")


@pytest.mark.parametrize("userblock", [0, 512, 2048])
def test_a_file_that_names_a_driver_is_refused_as_measurements_and_as_a_session(
    userblock, tmp_path
):
    path = tmp_path / "a.h5"
    path.write_bytes(bytes(userblock) + of_a_driver(size=16))
    assert names_a_driver(path)
    with pytest.raises(ForeignFileError, match="wanted an HDF5 file"):
        read_content(path, Hints())
    with pytest.raises(SessionError, match="cannot be read"):
        read_session(path)


@pytest.mark.parametrize("width", [4, 8])
@pytest.mark.parametrize(("version", "begin"), [(0, 24), (1, 28)])
def test_the_drivers_address_stands_where_the_specification_has_it(version, begin, width, tmp_path):
    sign = b"\x89HDF\r\n\x1a\n"
    head = (sign + bytes([version, 0, 0, 0, 0, width, width])).ljust(begin, b"\0")
    for address, names in ((b"\xff" * width, False), (b"\x1e".ljust(width, b"\0"), True)):
        whole = head + bytes(width) + b"\xff" * width + bytes(width) + address + bytes(100)
        (tmp_path / "a").write_bytes(whole)
        assert names_a_driver(tmp_path / "a") == names


@pytest.mark.parametrize("data", [b"", b"\x89HDF\r\n\x1a\n", b"\x89HDF\r\n\x1a\n" + bytes(5)])
def test_what_is_cut_off_is_left_to_hdf5(data, tmp_path):
    (tmp_path / "a").write_bytes(data)
    assert not names_a_driver(tmp_path / "a")
