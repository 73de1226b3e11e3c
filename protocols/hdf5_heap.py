"""Global heaps of an HDF5 file, looked at before HDF5 reads texts of variable length from them.

A heap is a chain of objects: index, count, four bytes of nothing, size (u16, u16, u64, little
endian), and the object. Where the chain has a step of no length, or one so long that it leads back
in 64 bits, HDF5 goes round in it for ever. No step of a heap leads beyond it.

References
----------
HDF5 File Format Specification, version 3.0, III.E "Disk Format: Level 1E - Global Heap".
"""

from __future__ import annotations

import struct
from pathlib import Path

from armodal.protocols.hdf5_bytes import FileBytes, mapped

__all__ = ["has_endless_heap"]

_SIGN = b"GCOL\x01"
_HEAD = struct.Struct("<8xQ")  # sign, version and nothing; size of the collection
_OBJECT = struct.Struct("<HHIQ")
_ALIGNED = 8


def has_endless_heap(path: Path) -> bool:
    """Whether a file has a heap whose chain of objects comes to no end.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with mapped(path) as data:
        at = data.find(_SIGN)
        while at >= 0:
            if _is_endless(data, at):
                return True
            at = data.find(_SIGN, at + 1)
    return False


def _is_endless(data: FileBytes, begin: int) -> bool:
    if begin + _HEAD.size > len(data):
        return False
    (size,) = _HEAD.unpack_from(data, begin)
    end = min(begin + size, len(data))
    at = begin + _HEAD.size
    while at + _OBJECT.size <= end:
        index, _, _, length = _OBJECT.unpack_from(data, at)
        # What is free is as long as it says; an object is longer by its head, and aligned.
        step = length if index == 0 else _OBJECT.size + -(-length // _ALIGNED) * _ALIGNED
        if step == 0 or at + step > begin + size:
            return True
        at += step
    return False
