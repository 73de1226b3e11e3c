"""NumPy files of several arrays."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.formats.excel import is_workbook
from armodal.protocols.foreign.numpy_files import npz_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="NPZ",
    holds="arrays by name. Nothing is ever unpickled",
    endings=(),  # a damaged archive has nothing to read
    is_it=lambda head: head.startswith((b"PK\x03\x04", b"PK\x05\x06")) and not is_workbook(head),
    variables=of_bytes(npz_variables),
)
