"""NPY and NPZ files. Nothing is unpickled, and nothing is loaded before its size is known."""

from __future__ import annotations

import io
import math
import struct
import tokenize
import zipfile
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.bounds import MOST_NUMBERS, most_decoded_bytes
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.roles import split_unit
from armodal.protocols.foreign.variables import Listed, Variable, Variables

__all__ = ["npy_array", "npy_variables", "npz_variables"]

_MOST_ROWS = 64
_MOST_MEMBERS = 256
# numpy reads the header of an array as Python text.
_HEADER_ERRORS = (
    ValueError,
    OSError,
    TypeError,
    SyntaxError,
    KeyError,
    tokenize.TokenError,
    RecursionError,
    MemoryError,
)
_ZIP_ERRORS = (
    struct.error,
    zipfile.BadZipFile,
    zipfile.LargeZipFile,
    zlib.error,
    OSError,
    RuntimeError,
    EOFError,
    OverflowError,
    ValueError,
)


def npy_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the rows (or columns) of a plain table, one signal, or complex FRFs.

    Raises
    ------
    ForeignFileError
        If the file is damaged, holds objects, or has too many dimensions.
    """
    array = npy_array(data, origin)
    if np.iscomplexobj(array):
        if array.ndim > 3 or array.size < 2:
            raise _shape(array, origin)
        return (_part(origin, "NPY", [Variable(name="array", values=array)], named=True),)
    if array.ndim == 1 and array.size > 1:
        array = array[None]  # one signal: of a force beside its responses
    elif array.ndim != 2 or min(array.shape) < 2 or min(array.shape) > _MOST_ROWS:
        raise _shape(array, origin)
    rows = array if array.shape[0] <= array.shape[1] else array.T
    columns = [
        Variable(name=f"column {i + 1}", values=np.ascontiguousarray(row))
        for i, row in enumerate(rows)
    ]
    return (_part(origin, "NPY", columns, named=False),)


def _shape(array: npt.NDArray[Any], origin: str) -> ForeignFileError:
    kind = "complex" if np.iscomplexobj(array) else "real"
    return ForeignFileError(
        f"{origin}: wanted rows of time, force and at least one acceleration, up to {_MOST_ROWS}, "
        f"or complex FRFs, got a {kind} array of shape {array.shape}; save it as such"
    )


def npz_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the arrays of an NPZ file.

    Raises
    ------
    ForeignFileError
        If the file is damaged, too large, or an array holds objects.
    """
    variables = []
    texts: dict[str, tuple[str, ...]] = {}
    others = []
    contents = _members(data, origin)
    left = most_decoded_bytes(len(data)) // 8  # of all together: small types become float64
    for name in list(contents):
        content = contents.pop(name)
        array = npy_array(content, f"{origin}: {name}", texts_too=True, most=left)
        left -= array.size
        if array.dtype.kind in "US":
            texts[name] = tuple(str(word) for word in array.reshape(-1)[:1000])
        elif array.ndim > 3 or array.size == 0:
            others.append(Listed(name=name, shape=array.shape, type=array.dtype.name))
        else:
            variables.append(Variable(name=name, values=array, unit=split_unit(name)[1]))
    part = _part(origin, "NPZ", variables, named=True, texts=texts, others=tuple(others))
    return (part,)


def _part(origin: str, kind: str, variables: list[Variable], **more: Any) -> Variables:
    return Variables(origin=origin, format=kind, variables=tuple(variables), **more)


def npy_array(
    data: bytes, origin: str, *, texts_too: bool = False, most: int = MOST_NUMBERS
) -> npt.NDArray[Any]:
    """Return the array of an NPY file's bytes, its size checked before it is made."""
    stream = io.BytesIO(data)
    try:
        shape, dtype = _npy_header(stream)
    except _HEADER_ERRORS as error:
        raise ForeignFileError(
            f"{origin}: wanted an NPY file, it cannot be read ({_first(error)}); save it again"
        ) from error
    is_text = texts_too and dtype.kind in "US"
    if not is_text and (dtype.kind not in "fiucb" or dtype.itemsize > 16):
        raise ForeignFileError(
            f"{origin}: wanted plain numbers, got {dtype.str!r} (objects are never unpickled); "
            "save it with numpy.save as float64"
        )
    count = math.prod(int(size) for size in shape)
    left = len(data) - stream.tell()
    if count > most:
        raise ForeignFileError(f"{origin}: wanted at most {most} numbers, got more; split the file")
    if count * dtype.itemsize != left:
        raise ForeignFileError(
            f"{origin}: wanted the {count} numbers of shape {shape} that its header announces, "
            f"got {left} bytes of {dtype.str}: truncated or damaged; save it again"
        )
    try:
        array: npt.NDArray[Any] = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, OSError) as error:
        raise ForeignFileError(f"{origin}: cannot be read ({_first(error)})") from error
    if is_text:
        return array
    wanted = np.complex128 if array.dtype.kind == "c" else np.float64
    return np.asarray(array, dtype=wanted)


def _npy_header(stream: io.BytesIO) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = np.lib.format.read_magic(stream)
    read = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if read is None:
        raise ValueError(f"NPY version {version}")
    shape, _, dtype = read(stream)
    return shape, dtype


def _members(data: bytes, origin: str) -> dict[str, bytes]:
    """Return the members of a ZIP archive by their names, which are never paths here."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            whole = sum(m.file_size for m in members)
            if len(members) <= _MOST_MEMBERS and whole <= most_decoded_bytes(len(data)):
                return {
                    member.filename.removesuffix(".npy")[:40]: _content(archive, member)
                    for member in members
                }
    except _ZIP_ERRORS as error:
        raise ForeignFileError(
            f"{origin}: wanted an NPZ file, it cannot be read ({_first(error)}); save it again"
        ) from error
    raise ForeignFileError(
        f"{origin}: wanted at most {_MOST_MEMBERS} arrays of "
        f"{most_decoded_bytes(len(data)) // 10**6} MB together, got {len(members)} of "
        f"{whole // 10**6} MB; split the file, or save it uncompressed"
    )


def _content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    if member.compress_type not in {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
        raise ValueError(f"compression {member.compress_type}, wanted none or deflate")
    with archive.open(member) as stream:
        return stream.read(member.file_size)


def _first(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:160]
