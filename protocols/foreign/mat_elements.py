"""The elements of a MATLAB file (version 5), walked before scipy's reader is let near them.

scipy looks types up in tables by the number that stands in the file, whatever it is, and may then
crash the process. So every element that it will read is known here by type and extent before.

References
----------
MathWorks, MAT-File Format (R2014b), chapter 1: tags, small elements, miMATRIX, miCOMPRESSED.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator

from armodal.protocols.bounds import most_decoded_bytes

__all__ = ["plain_variables"]

HEADER_BYTES = 128
VERSION_5 = 0x0100
PIECE_BYTES = 2**22  # decompressed at a time: a variable that is too large is never held
MOST_CELLS = 100_000
_MEMBER_BYTES = 200  # of an array in a cell, however small
_COMPRESSED, _MATRIX = 15, 14
_INT8, _INT32, _UINT32 = 1, 5, 6
_NUMBERS = frozenset({1, 2, 3, 4, 5, 6, 7, 9, 12, 13})
_TEXTS = frozenset({1, 2, 3, 4, 16, 17, 18})
_CELL, _STRUCT, _CHAR = 1, 2, 4
_NUMERIC = range(6, 16)
_COMPLEX = 0x08
_MOST_DIMENSIONS = 32
_DEEPEST = 5  # structs and cells within one another
_LONGEST_FIELD = 64


class _NotPlain(Exception):  # noqa: N818 - says what a variable is, and is not an error
    """An object, a function, or what holds one: something that is not read."""


class _Room:
    """What may still be held of a file."""

    def __init__(self, most: int) -> None:
        self._most = self._left = most

    def take(self, wanted: int) -> None:
        """Count bytes that will be held."""
        self._left -= wanted
        if self._left < 0:
            raise ValueError(f"more than {self._most // 10**6} MB of numbers in a file of its size")


def plain_variables(data: bytes) -> list[str]:
    """Return the names of the variables that are numbers, texts, or cells and structs of them.

    Raises
    ------
    ValueError
        If the file is not of version 5, or an element is not what its tag says.
    """
    if len(data) < HEADER_BYTES or data[126:128] not in {b"IM", b"MI"}:
        raise ValueError("no MATLAB file of version 5")
    order = "<" if data[126:128] == b"IM" else ">"
    (version,) = struct.unpack_from(f"{order}H", data, 124)
    if version != VERSION_5:
        raise ValueError(f"version {version:#06x}, wanted {VERSION_5:#06x}")
    names = []
    left = most_decoded_bytes(len(data))  # to unpack
    room = _Room(left)
    whole = memoryview(data)
    at = HEADER_BYTES
    while at < len(data):
        if len(data) - at < 8:
            raise ValueError(f"byte {at}: a tag that is cut off")
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind not in {_COMPRESSED, _MATRIX} or size > len(data) - at - 8:
            raise ValueError(f"byte {at}: an element of type {kind} with {size} bytes")
        body = whole[at + 8 : at + 8 + size]
        at += 8 + size
        if kind == _COMPRESSED:
            body = _inflated(body, order, left)
            left -= len(body)
        try:
            names.append(_check_matrix(body, order, 0, room))
        except _NotPlain:
            continue
    return names


def _inflated(body: memoryview, order: str, most: int) -> memoryview:
    """Return the matrix in a compressed element, of at most `most` bytes."""
    reader = zlib.decompressobj()
    whole = bytearray()
    left: bytes | memoryview = body
    while not reader.eof:
        try:
            piece = reader.decompress(left, PIECE_BYTES)
        except zlib.error as error:
            raise ValueError(str(error)) from error
        whole += piece
        left = reader.unconsumed_tail
        if len(whole) > most or not (piece or reader.eof):
            raise ValueError("compressed data that are cut off or too large")
    if len(whole) < 8:
        raise ValueError("compressed data that are cut off")
    kind, size = struct.unpack_from(f"{order}II", whole)
    if kind != _MATRIX or size != len(whole) - 8:
        raise ValueError(f"compressed element of type {kind} with {size} of {len(whole) - 8} bytes")
    return memoryview(whole)[8:]


def _elements(body: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Yield type and data of the elements in a matrix."""
    at = 0
    while at < len(body):
        if len(body) - at < 8:
            raise ValueError("a tag that is cut off within an array")
        first, size = struct.unpack_from(f"{order}II", body, at)
        if first >> 16:  # a small element: size, type and up to four bytes in one
            kind, size, start = first & 0xFFFF, first >> 16, at + 4
            if size > 4:
                raise ValueError(f"a small element of {size} bytes")
            end = at + 8
        else:
            kind, start = first, at + 8
            end = start + size + -size % 8
        if start + size > len(body):
            raise ValueError(f"an element of {size} bytes that is cut off")
        yield kind, body[start : start + size]
        at = end


def _next(
    elements: Iterator[tuple[int, memoryview]], kinds: frozenset[int], what: str
) -> memoryview:
    kind, data = next(elements, (0, memoryview(b"")))
    if kind not in kinds:
        raise ValueError(f"{what} of type {kind}")
    return data


def _check_matrix(body: memoryview, order: str, depth: int, room: _Room) -> str:
    """Check an array and return its name; raise _NotPlain where it is none of ours."""
    if not body and depth:
        return ""  # an empty cell
    elements = _elements(body, order)
    flags = _next(elements, frozenset({_UINT32}), "array flags")
    if len(flags) != 8:
        raise ValueError(f"array flags of {len(flags)} bytes")
    (word,) = struct.unpack_from(f"{order}I", flags)
    kind, is_complex = word & 0xFF, bool(word >> 8 & _COMPLEX)
    if kind not in _NUMERIC and kind not in {_CELL, _STRUCT, _CHAR}:
        raise _NotPlain
    shape = _next(elements, frozenset({_INT32}), "dimensions")
    n = len(shape) // 4
    if len(shape) % 4 or not 2 <= n <= _MOST_DIMENSIONS:
        raise ValueError(f"dimensions of {len(shape)} bytes")
    sizes = struct.unpack(f"{order}{n}i", shape)
    if min(sizes) < 0:
        raise ValueError(f"dimensions {sizes}")
    name = bytes(_next(elements, frozenset({_INT8}), "a name")).decode("latin-1")
    if kind in {_CELL, _STRUCT}:
        members = math.prod(sizes) * (_fields(elements, order) if kind == _STRUCT else 1)
        if depth >= _DEEPEST or members > MOST_CELLS:
            raise ValueError("cells and structs too deep within one another, or too many of them")
        room.take(members * _MEMBER_BYTES)
        for _ in range(members):
            member = _next(elements, frozenset({_MATRIX}), "a member")
            _check_matrix(member, order, depth + 1, room)
    else:
        kinds = _TEXTS if kind == _CHAR else _NUMBERS
        room.take(math.prod(sizes) * (16 if is_complex else 8))
        _next(elements, kinds, "data")
        if is_complex:
            _next(elements, _NUMBERS, "an imaginary part")
    return name


def _fields(elements: Iterator[tuple[int, memoryview]], order: str) -> int:
    """Return how many fields a struct has, its names checked."""
    length = _next(elements, frozenset({_INT32}), "a length of names")
    if len(length) != 4:
        raise ValueError(f"a length of names of {len(length)} bytes")
    (each,) = struct.unpack(f"{order}i", length)
    names = _next(elements, frozenset({_INT8}), "names of fields")
    if not 0 < each <= _LONGEST_FIELD or len(names) % each:
        raise ValueError(f"{len(names)} bytes of names of {each}")
    whole = bytes(names)
    told = [whole[i : i + each].split(b"\0")[0] for i in range(0, len(whole), each)]
    if len(set(told)) != len(told) or not all(told):
        raise ValueError("fields without names, or of one name")
    return len(told)
