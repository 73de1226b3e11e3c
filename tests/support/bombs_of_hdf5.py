"""HDF5 files that tell false lengths, for which HDF5 makes room before it looks for what is there.

References
----------
HDF5 File Format Specification, version 3.0, IV.B "Variable-length datatypes" (length, address of
the heap, index in it) and VII.B "Global Heap Block for Virtual Datasets" (version, count, names).
"""

from __future__ import annotations

import io
import re
import struct
from collections.abc import Iterator

import h5py
import numpy as np
from support.bombs import bomb

_HEAP = b"GCOL\x01"
_TAIL = 12  # bytes of a place behind its length: address, index
_MOST_INDEX = 10_000
LONG = 0x3000_0000  # bytes; HDF5 refuses none below 4 GiB for being long


def lengths_told(data: bytes, base: int = 0) -> list[int]:
    """Return where a file tells the length of something of variable length.

    `base` is the length of what stands before the HDF5 file.
    """
    places = []
    for heap in re.finditer(re.escape(_HEAP), data):
        address = struct.pack("<Q", heap.start() - base)
        for at in re.finditer(re.escape(address), data):
            begin = at.start() - 4
            if begin < 0 or begin + 4 + _TAIL > len(data):
                continue
            length, index = struct.unpack_from("<I8xI", data, begin)
            if 0 < length < len(data) and 0 < index < _MOST_INDEX:
                places.append(begin)
    return sorted(places)


def with_false_lengths(data: bytes, length: int = LONG, base: int = 0) -> Iterator[bytes]:
    """Yield a file once for each length that it tells, and that one told wrong."""
    for at in lengths_told(data, base):
        changed = bytearray(data)
        struct.pack_into("<I", changed, at, length)
        yield bytes(changed)


def with_a_virtual(data: bytes, name: str, shape: tuple[int, ...], entries: int) -> bytes:
    """Return an HDF5 file with a virtual dataset of so many parts, of which it has two."""
    stream = io.BytesIO(data)
    with h5py.File(stream, "a" if data else "w") as file:
        if name in file:
            del file[name]
        layout = h5py.VirtualLayout(shape or (2,), "f8")
        for i in range(2):
            layout[i] = h5py.VirtualSource("other.h5", "part", (1,))[0]
        file.create_virtual_dataset(name, layout)
    changed = bytearray(stream.getvalue())
    at = changed.index(b"other.h5\0part\0")
    struct.pack_into("<Q", changed, at - 8, entries)
    return bytes(changed)


def _texts() -> bytes:
    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        told = file.create_dataset("words", (3,), h5py.string_dtype())
        told[:] = ["wood", "steel", "plastic"]
        file["a"] = np.arange(100.0)
    return stream.getvalue()


def _attribute(name: str) -> bytes:
    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        file["a"] = np.arange(100.0)
        file["a"].attrs[name] = "m/s^2"
    return stream.getvalue()


@bomb(("content", "session"), ".h5")
def a_text_told_longer() -> bytes:
    return next(with_false_lengths(_texts()))


@bomb(("content",), ".nc")
def a_unit_told_longer() -> bytes:
    return next(with_false_lengths(_attribute("units")))


@bomb(("content",), ".mat")
def a_class_told_longer() -> bytes:
    head = b"MATLAB 7.3 MAT-file, Platform: PCWIN64".ljust(124) + b"\x00\x02IM"
    return head.ljust(512, b"\0") + next(with_false_lengths(_attribute("MATLAB_class")))


@bomb(("content",), ".h5")
def a_virtual_dataset_of_millions() -> bytes:
    return with_a_virtual(_texts(), "virtual", (), 2**24)


@bomb(("session",), ".h5")
def a_session_of_millions_of_parts() -> bytes:
    return with_a_virtual(b"", "session/definition", (), 2**24)
