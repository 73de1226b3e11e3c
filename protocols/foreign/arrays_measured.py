"""Measurements in plain arrays: NPY, NPZ, CSV, a column of complex numbers, MATLAB.

Nothing is unpickled, and nothing is loaded before its size is known.
"""

from __future__ import annotations

import io
import math
import re
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import (
    Content,
    ForeignFrf,
    ForeignHit,
    Hints,
    ToldDof,
    check_frf_values,
    exact_rate,
)
from armodal.protocols.foreign.uff_blocks import read_foreign_bytes
from armodal.protocols.foreign.uff_records import DataKind
from armodal.protocols.foreign.units import seconds, signal_scale
from armodal.protocols.frf_records import FrfForm

__all__ = ["array_content", "npy_array", "signals_content"]

MOST_NUMBERS = 2**26
_TEXT_LIMIT = 512 * 2**20
_KIND_OF_FORM = {
    FrfForm.RECEPTANCE: DataKind.DISPLACEMENT,
    FrfForm.MOBILITY: DataKind.VELOCITY,
    FrfForm.ACCELERANCE: DataKind.ACCELERATION,
}
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
)
_NAME_UNIT = re.compile(r"[\[(]([^\])]*)[\])]\s*$")
_TIME = ("time", "t", "time_s", "t_s", "time_ms", "t_ms", "time_us", "t_us")
_FORCE = ("force", "hammer", "force_n", "f")


def array_content(path: Path, hints: Hints) -> Content:
    """Return the single hit, or the FRF, of an NPY, NPZ, CSV or text file.

    Raises
    ------
    ForeignFileError
        If the file is damaged, holds objects, or is not a time record or a column of an FRF.
    """
    data = read_foreign_bytes(path, limit=_TEXT_LIMIT)
    suffix = path.suffix.lower()
    if suffix == ".npy":
        array = npy_array(data, path.name)
        if np.iscomplexobj(array):
            return _column_frf(array.reshape(-1), hints, path.name)
        return signals_content(_named_rows(array, path.name), hints, path.name)
    if suffix == ".npz":
        return signals_content(_npz(data, path.name), hints, path.name)
    return _text(data, hints, path.name)


def npy_array(data: bytes, origin: str) -> npt.NDArray[Any]:
    """Return the array of an NPY file's bytes, its size checked before it is made."""
    stream = io.BytesIO(data)
    try:
        shape, dtype = _npy_header(stream)
    except _HEADER_ERRORS as error:
        raise ForeignFileError(
            f"{origin}: wanted an NPY file, it cannot be read ({_first(error)}); save it again"
        ) from error
    if dtype.kind not in "fiuc" or dtype.itemsize > 16:
        raise ForeignFileError(
            f"{origin}: wanted plain numbers, got {dtype.str!r} (objects are never unpickled); "
            "save it with numpy.save as float64"
        )
    count = math.prod(int(size) for size in shape)
    left = len(data) - stream.tell()
    if count > MOST_NUMBERS or count * dtype.itemsize != left:
        raise ForeignFileError(
            f"{origin}: wanted the {count} numbers of shape {shape} that its header announces, "
            f"got {left} bytes of {dtype.str}: truncated or damaged; save it again"
        )
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, OSError) as error:
        raise ForeignFileError(f"{origin}: cannot be read ({_first(error)})") from error
    if array.dtype.kind == "c":
        return np.asarray(array, dtype=np.complex128)
    return np.asarray(array, dtype=np.float64)


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


def signals_content(
    signals: Mapping[str, npt.NDArray[np.float64]], hints: Hints, origin: str
) -> Content:
    """Return the hit of named signals: time, force, and every other an acceleration."""
    names = list(signals)
    time = _pick(names, _TIME)
    force = _pick([name for name in names if name != time], _FORCE)
    responses = [name for name in names if name not in {time, force}]
    if time is None or force is None or not responses:
        raise ForeignFileError(
            f"{origin}: wanted signals called time, force and at least one acceleration, got "
            f"{', '.join(names)[:200]}; rename them"
        )
    said: list[str] = []
    rows = [_in_si(signals[force], force, DataKind.EXCITATION_FORCE, hints, origin, said)]
    rows += [
        _in_si(signals[name], name, DataKind.ACCELERATION, hints, origin, said)
        for name in responses
    ]
    times = np.asarray(signals[time]) * _seconds(time, origin)
    if any(row.shape != times.shape or row.ndim != 1 for row in rows):
        raise ForeignFileError(f"{origin}: wanted signals of one length, got several")
    if not all(np.isfinite(row).all() for row in rows):
        raise ForeignFileError(f"{origin}: wanted finite samples, got NaN or infinity")
    told = hints.responses or tuple(ToldDof(None, None) for _ in responses)
    if len(told) != len(responses):
        raise ForeignFileError(
            f"{origin}: wanted {len(told)} responses, as the manifest says, got {len(responses)}"
        )
    hit = ForeignHit(
        origin=origin,
        rate_hz=exact_rate(times, origin),
        force_n=frozen_array(rows[0], np.float64),
        acceleration_m_s2=frozen_array(np.stack(rows[1:]), np.float64),
        hit=hints.reference or ToldDof(None, None),
        responses=told,
    )
    return Content(origin=origin, hits=(hit,), said=tuple(dict.fromkeys(said)))


def _in_si(
    values: npt.NDArray[np.float64],
    name: str,
    kind: DataKind,
    hints: Hints,
    origin: str,
    said: list[str],
) -> npt.NDArray[np.float64]:
    label = hints.force_unit if kind is DataKind.EXCITATION_FORCE else hints.response_unit
    label = label or _unit_of(name)
    if label is None:
        said.append(
            f"{origin}: the units are not told; the numbers are taken as SI (N, m/s^2). "
            "Say `units` in the manifest"
        )
        return np.asarray(values, dtype=np.float64)
    return np.asarray(values, dtype=np.float64) * signal_scale(kind, label, None, origin).factor


def _seconds(name: str, origin: str) -> float:
    """Return seconds per unit of a time column: `time`, `time [ms]`, `t_us`."""
    match = _NAME_UNIT.search(name)
    told = match[1].strip() if match else ""
    bare = _NAME_UNIT.sub("", name).strip().lower()
    if not told and bare in {"time", "t"}:
        return 1.0
    factor = seconds(told or bare.rpartition("_")[2])
    if factor is None:
        raise ForeignFileError(
            f"{origin}: wanted a time in s, ms or us, such as 'time [ms]' or 'time_s', got "
            f"{name[:40]!r}; convert it, or rename it"
        )
    return factor


def _unit_of(name: str) -> str | None:
    """Return the unit in a column's name: `force [N]`, `acc_x (g)`, `force_n`, `x_m_s2`."""
    match = _NAME_UNIT.search(name)
    if match and match[1].strip():
        return match[1].strip()
    for ending, label in (("_m_s2", "m/s^2"), ("_g", "g"), ("_n", "N")):
        if name.lower().endswith(ending):
            return label
    return None


def _pick(names: list[str], wanted: tuple[str, ...]) -> str | None:
    bare = {name: _NAME_UNIT.sub("", name).strip().lower() for name in names}
    exact = [name for name in names if bare[name] in wanted]
    begins = [name for name in names if bare[name].startswith(wanted[0])]
    found = exact or begins
    return found[0] if found else None


def _named_rows(array: npt.NDArray[Any], origin: str) -> dict[str, npt.NDArray[np.float64]]:
    """Name the rows (or columns) of a plain table: time, force, accelerations."""
    if array.ndim != 2 or min(array.shape) < 3:
        raise ForeignFileError(
            f"{origin}: wanted rows of time, force and at least one acceleration, got an array of "
            f"shape {array.shape}"
        )
    rows = array if array.shape[0] < array.shape[1] else array.T
    if len(rows) > 32:
        raise ForeignFileError(f"{origin}: wanted at most 32 channels, got {len(rows)}")
    names = ["time", "force", *(f"response {i + 1}" for i in range(len(rows) - 2))]
    return dict(zip(names, rows, strict=True))


def _npz(data: bytes, origin: str) -> dict[str, npt.NDArray[np.float64]]:
    signals: dict[str, npt.NDArray[np.float64]] = {}
    for name, content in _members(data, origin).items():
        array = npy_array(content, f"{origin}: {name}")
        if np.iscomplexobj(array) or array.ndim > 2:
            raise ForeignFileError(f"{origin}: {name}: wanted real signals, got others")
        for i, row in enumerate(_as_rows(array)):
            signals[name if array.ndim < 2 else f"{name} {i + 1}"] = row
    return signals


def _members(data: bytes, origin: str) -> dict[str, bytes]:
    """Return the members of a ZIP archive by their names, which are never paths here."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if len(members) <= 64 and sum(m.file_size for m in members) <= 8 * MOST_NUMBERS:
                return {
                    member.filename.removesuffix(".npy")[:40]: _content(archive, member)
                    for member in members
                }
    except (*_ZIP_ERRORS, ValueError) as error:
        raise ForeignFileError(
            f"{origin}: wanted an NPZ file, it cannot be read ({_first(error)}); save it again"
        ) from error
    raise ForeignFileError(f"{origin}: wanted at most 64 signals of 0.5 GB together, got more")


def _content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    if member.compress_type not in {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
        raise ValueError(f"compression {member.compress_type}, wanted none or deflate")
    with archive.open(member) as stream:
        return stream.read(member.file_size)


def _as_rows(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    rows = np.atleast_2d(array)
    return rows if rows.shape[0] <= rows.shape[1] else rows.T


def _text(data: bytes, hints: Hints, origin: str) -> Content:
    """Read numbers in columns, with or without a line of names, or one complex number a line."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ForeignFileError(f"{origin}: wanted UTF-8 text, got others ({error})") from error
    lines = [line for line in text.splitlines() if line.strip() and line.strip()[0] != "#"]
    if len(lines) < 2:
        raise ForeignFileError(f"{origin}: wanted a table of numbers, got {len(lines)} lines")
    if "j" in lines[0] and "," not in lines[0]:
        try:
            column = np.array([complex(line.strip().replace(" ", "")) for line in lines])
        except ValueError as error:
            raise ForeignFileError(
                f"{origin}: wanted one complex number a line ({_first(error)}); truncated?"
            ) from error
        return _column_frf(column, hints, origin)
    delimiter = next((c for c in ";\t," if c in lines[0]), None)
    names = [cell.strip().strip('"') for cell in lines[0].split(delimiter)]
    has_names = any(re.search("[a-df-z]", name, re.IGNORECASE) for name in names)
    try:
        table = np.loadtxt(lines[has_names:], delimiter=delimiter, ndmin=2, dtype=np.float64)
    except ValueError as error:
        raise ForeignFileError(
            f"{origin}: wanted a table of numbers ({_first(error)}); truncated or damaged?"
        ) from error
    if not has_names:
        return signals_content(_named_rows(table.T, origin), hints, origin)
    if len(names) != table.shape[1] or len(set(names)) != len(names):
        raise ForeignFileError(
            f"{origin}: wanted a name of its own for each of {table.shape[1]} columns, got {names}"
        )
    return signals_content(dict(zip(names, table.T, strict=True)), hints, origin)


def _column_frf(values: npt.NDArray[np.complex128], hints: Hints, origin: str) -> Content:
    """Return the FRF of a column of complex numbers; the manifest says the rest."""
    if hints.form is None or hints.line_spacing_hz is None:
        raise ForeignFileError(
            f"{origin}: a column of complex numbers tells neither its form nor its lines: say "
            "`form` and `line_spacing_hz` in the manifest"
        )
    said = []
    factor = 1.0
    if hints.response_unit is not None and hints.force_unit is not None:
        response = signal_scale(_KIND_OF_FORM[hints.form], hints.response_unit, None, origin)
        force = signal_scale(DataKind.EXCITATION_FORCE, hints.force_unit, None, origin)
        factor = response.factor / force.factor
    else:
        said.append(
            f"{origin}: the units are not told; the numbers are taken as SI (m, s, N). Say "
            "`units` in the manifest"
        )
    lines = np.arange(len(values), dtype=np.float64)
    freq = (hints.first_line_hz or 0.0) + hints.line_spacing_hz * lines
    keep = check_frf_values(freq, values, origin)
    if len(hints.responses) > 1:
        raise ForeignFileError(f"{origin}: wanted one response for one column, got several")
    frf = ForeignFrf(
        origin=origin,
        form=hints.form,
        response=hints.responses[0] if hints.responses else ToldDof(None, None),
        reference=hints.reference or ToldDof(None, None),
        freq_hz=frozen_array(freq[keep], np.float64),
        values=frozen_array(values[keep] * factor, np.complex128),
        coherence=None,
    )
    return Content(origin=origin, frfs=(frf,), said=tuple(said))


def _first(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:160]
