"""Virtual datasets of an HDF5 file, looked for before HDF5 opens it.

The data of a virtual dataset lie in other files, which are not read. How many parts it has is
told in a heap of the file; HDF5 makes room for so many, and where their sizes together do not fit
64 bits it writes beyond that room and crashes.

References
----------
HDF5 File Format Specification, version 3.0, III.E "Global Heap", IV.A.2.i "The Data Layout
Message", version 4: version, class 3 (virtual), address of a heap (8 bytes), index in it.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

from armodal.protocols.hdf5_bytes import FileBytes, mapped, superblock_at

__all__ = ["has_virtual_dataset"]

_HEAP = b"GCOL\x01"
# No file is of 2^48 bytes. Versions 4 and 5 of the message.
_LAYOUTS = tuple(
    re.compile(version + rb"\x03(?=.{6}\x00\x00)", re.DOTALL) for version in (b"\x04", b"\x05")
)


def has_virtual_dataset(path: Path) -> bool:
    """Whether a file has what would be the layout of a virtual dataset.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with mapped(path) as data:
        if data.find(_HEAP) < 0:
            return False
        base = superblock_at(data) or 0
        return any(
            _is_heap(data, base, layout.end())
            for of_version in _LAYOUTS
            for layout in of_version.finditer(data)
        )


def _is_heap(data: FileBytes, base: int, place: int) -> bool:
    (address,) = struct.unpack_from("<Q", data, place)
    return data[base + address : base + address + len(_HEAP)] == _HEAP
