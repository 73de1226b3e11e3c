"""NumPy files of one array."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.numpy_files import npy_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="NPY",
    endings=(".npy",),
    is_it=lambda head: head.startswith(b"\x93NUMPY"),
    variables=of_bytes(npy_variables),
)
