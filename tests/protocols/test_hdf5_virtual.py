"""Virtual datasets are seen before HDF5 makes room for their parts."""

from __future__ import annotations

import h5py
import pytest
from support.bombs_of_hdf5 import with_a_virtual

from armodal.protocols.errors import ForeignFileError, SessionError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.hdf5_virtual import has_virtual_dataset
from armodal.protocols.session.hdf5 import read_session


def a_file(path, userblock, library):
    with h5py.File(path, "w", userblock_size=userblock, libver=library) as file:
        file["words"] = ["a", "longer", ""]
        file["a"] = [1.0, 2.0]


@pytest.mark.parametrize("userblock", [0, 512, 2048])
@pytest.mark.parametrize("library", ["earliest", "v110", "latest"])
def test_a_virtual_dataset_is_seen_in_files_of_any_version(userblock, library, tmp_path):
    path = tmp_path / "a.h5"
    a_file(path, userblock, library)
    assert b"GCOL" in path.read_bytes()
    assert not has_virtual_dataset(path)
    path.write_bytes(with_a_virtual(path.read_bytes(), "virtual", (2,), 2))
    with h5py.File(path) as file:
        assert file["virtual"].is_virtual
    assert has_virtual_dataset(path)
    with pytest.raises(ForeignFileError, match="whose data lie in other files"):
        read_content(path, Hints())
    with pytest.raises(SessionError, match="data in another file"):
        read_session(path)


@pytest.mark.parametrize(
    "data", [b"", b"GCOL\x01", b"GCOL\x01\x04\x03", b"GCOL\x01\x04\x03" + bytes(7)]
)
def test_what_is_cut_off_has_none(data, tmp_path):
    (tmp_path / "a").write_bytes(data)
    assert not has_virtual_dataset(tmp_path / "a")
