"""NumPy files of one array."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.numpy_files import npy_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="NPY",
    holds=("a table of time s, force, accelerations, one channel a row or column; or complex FRFs"),
    endings=(".npy",),
    is_it=lambda head: head.startswith(b"\x93NUMPY"),
    variables=of_bytes(npy_variables),
)
