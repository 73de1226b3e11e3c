"""HDF5 files, and MATLAB's of version 7.3, which put 512 bytes of their own before."""

from armodal.protocols.foreign.file_format import FileFormat
from armodal.protocols.foreign.hdf5_variables import hdf5_variables

__all__ = ["FORMAT"]

_SIGN = b"\x89HDF\r\n\x1a\n"

FORMAT = FileFormat(
    name="HDF5",
    holds=(
        "arrays of any group, `group.name`; files of Rattlesnake with their units, degrees of "
        "freedom and averages"
    ),
    endings=(".h5", ".hdf5", ".nc", ".nc4"),
    is_it=lambda head: head.startswith(_SIGN) or head[512:520] == _SIGN,
    variables=lambda path, _: hdf5_variables(path),
)
