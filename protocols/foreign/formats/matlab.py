"""MATLAB files up to version 7; those of 7.3 are HDF5."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.mat import mat_variables

__all__ = ["FORMAT"]


def _is_it(head: bytes) -> bool:
    return head[126:128] in {b"IM", b"MI"} and head[124:126] in {b"\x00\x01", b"\x01\x00"}


FORMAT = FileFormat(
    name="MATLAB",
    holds=(
        "version 5 to 7.2 by scipy, 7.3 by h5py; fields of a struct are called "
        "`Signal.y_values.values`; axes told by `x_values.start_value` and `increment`, as "
        "Simcenter Testlab writes them"
    ),
    endings=(".mat",),
    is_it=_is_it,
    variables=of_bytes(mat_variables),
)
