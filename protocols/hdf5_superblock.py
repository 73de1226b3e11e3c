"""The superblock of an HDF5 file, looked at before HDF5 opens it.

Files of several parts have a driver information block, which their superblock names. HDF5 makes
room for as many bytes as that block says that it has, up to 4 GiB, before it reads them. What one
file holds needs none.

References
----------
HDF5 File Format Specification, version 3.0, II.A "Disk Format: Level 0A - Format Signature and
Superblock", II.B "Disk Format: Level 0B - File Driver Info".
"""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.hdf5_bytes import mapped, superblock_at

__all__ = ["names_a_driver"]

_ADDRESSES_AT = {0: 24, 1: 28}  # by version; later ones have no address of a driver's block
_VERSION_AT, _SIZE_AT = 8, 13  # the latter is of an address, bytes
_DRIVER = 3  # addresses stand before the driver's
_LONGEST = _ADDRESSES_AT[1] + 256 * (_DRIVER + 1)  # up to the driver's end, whatever their size


def names_a_driver(path: Path) -> bool:
    """Whether a file's superblock has the address of a driver information block.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with mapped(path) as data:
        at = superblock_at(data)
        return at is not None and _has_address(data[at : at + _LONGEST])


def _has_address(head: bytes) -> bool:
    if len(head) <= _SIZE_AT or head[_VERSION_AT] not in _ADDRESSES_AT:
        return False
    begin, width = _ADDRESSES_AT[head[_VERSION_AT]], head[_SIZE_AT]
    address = head[begin + _DRIVER * width : begin + (_DRIVER + 1) * width]
    return address != b"\xff" * width  # which is no address
