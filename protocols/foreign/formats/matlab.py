"""MATLAB files up to version 7; those of 7.3 are HDF5."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.mat import mat_variables

__all__ = ["FORMAT"]


def _is_it(head: bytes) -> bool:
    return head[126:128] in {b"IM", b"MI"} and head[124:126] in {b"\x00\x01", b"\x01\x00"}


FORMAT = FileFormat(
    name="MATLAB", endings=(".mat",), is_it=_is_it, variables=of_bytes(mat_variables)
)
