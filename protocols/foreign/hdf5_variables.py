"""HDF5 files of other programs as named arrays: MATLAB 7.3, netCDF, plain HDF5.

Only what is in the file itself is read: hard links, no external or virtual data, no filters but
gzip, shuffle and checksums, nothing whose size is not known before. Datasets in groups are named
after them, `test.frf`. HDF5 itself makes room for what a file says, so it is bounded meanwhile.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from armodal.protocols.apart import most_bytes_beside
from armodal.protocols.bounds import most_decoded_bytes
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.rattlesnake import is_rattlesnake, rattlesnake_variables
from armodal.protocols.foreign.roles import split_unit
from armodal.protocols.foreign.variables import Listed, Variable, Variables
from armodal.protocols.hdf5_heap import has_endless_heap
from armodal.protocols.hdf5_superblock import names_a_driver
from armodal.protocols.hdf5_virtual import has_virtual_dataset
from armodal.protocols.memory_bound import at_most_more

__all__ = ["hdf5_variables"]

_FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}
_ERRORS = (
    OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError, MemoryError,
    AttributeError, IndexError, UnicodeDecodeError, SystemError,
)  # fmt: skip
_DEEPEST = 5
_MOST_DATASETS = 2000
_MOST_TEXTS = 10_000
_MOST_CHUNK = 2**28
_PARTS = (("real", "imag"), ("r", "i"))
_HIDDEN = {"#refs#", "#subsystem#"}


def hdf5_variables(path: Path) -> tuple[Variables, ...]:
    """Return the arrays of an HDF5 file.

    Raises
    ------
    ForeignFileError
        If HDF5 cannot read it, or it is too large.
    """
    origin = path.name
    try:
        _check_bytes(path)
        size = path.stat().st_size
        with (
            at_most_more(most_bytes_beside(size)),
            h5py.File(path, "r", locking="best-effort") as file,
        ):
            reader = _Reader(file, origin, most_decoded_bytes(size))
            part = reader.part()
            if is_rattlesnake(part, dict(reader.numbers_of(file))):
                return rattlesnake_variables(part, reader.settings)
            return (part,)
    except _ERRORS as error:
        if isinstance(error, ForeignFileError):
            raise
        raise ForeignFileError(
            f"{origin}: wanted an HDF5 file, it cannot be read as one: truncated, damaged, or of "
            "far more than its size? Save it again"
        ) from error


def _check_bytes(path: Path) -> None:
    """Raise before HDF5 opens what it would go round in, or what would crash it."""
    if has_endless_heap(path) or names_a_driver(path):
        raise OSError("a heap without end, or a driver's block")
    if has_virtual_dataset(path):
        raise ForeignFileError(
            f"{path.name}: wanted an HDF5 file that holds its data itself, got a virtual dataset, "
            "whose data lie in other files; copy them into one"
        )


class _Reader:
    """One pass over a file, with what may still be read."""

    def __init__(self, file: h5py.File, origin: str, most: int) -> None:
        self._file = file
        self._origin = origin
        self._most = self._left = most  # bytes
        self.settings: dict[str, float] = {}

    def part(self) -> Variables:
        """Return everything in the file."""
        variables: list[Variable] = []
        texts: dict[str, tuple[str, ...]] = {}
        others: list[Listed] = []
        self.settings.update(self.numbers_of(self._file))
        for name, dataset in self._datasets(self._file, "", 0):
            words = self._words(dataset)
            if words is not None:
                texts[name] = words
                continue
            values = self._numbers(dataset)
            if values is None or values.size == 0:
                shape = tuple(dataset.shape or ())
                others.append(Listed(name=name, shape=shape, type=str(dataset.dtype)[:40]))
                continue
            told = dataset.attrs.get("units", dataset.attrs.get("unit", b""))
            unit = told if isinstance(told, str) else split_unit(name)[1]
            variables.append(Variable(name=name, values=values, unit=unit))
        return Variables(
            origin=self._origin,
            format="HDF5",
            variables=tuple(variables),
            texts=texts,
            others=tuple(others),
        )

    def numbers_of(self, group: Any) -> Iterator[tuple[str, float]]:
        """Yield the attributes of a group that are single numbers."""
        prefix = group.name.strip("/").replace("/", ".")
        for key in list(group.attrs)[:100]:
            space = h5py.h5a.open(group.id, key.encode())
            if space.dtype.kind in "iuf" and math.prod(space.shape) == 1:
                value = np.asarray(group.attrs[key]).reshape(-1)[0]
                yield (f"{prefix}.{key}" if prefix else key), float(value)

    def _datasets(self, group: Any, prefix: str, depth: int) -> Iterator[tuple[str, Any]]:
        names = list(group.keys())
        if len(names) > _MOST_DATASETS:
            raise ForeignFileError(
                f"{self._origin}: wanted at most {_MOST_DATASETS} datasets, got {len(names)}"
            )
        for name in names:
            if name in _HIDDEN or not isinstance(group.get(name, getlink=True), h5py.HardLink):
                continue
            path = f"{prefix}{name}"
            kind = group.get(name, getclass=True)
            if kind is h5py.Dataset:
                yield path, group[name]
            elif kind is h5py.Group and depth < _DEEPEST:
                self.settings.update(self.numbers_of(group[name]))
                yield from self._datasets(group[name], f"{path}.", depth + 1)

    def _readable(self, dataset: Any) -> bool:
        """Whether a dataset's data are here, small enough, and read by filters that are known."""
        if dataset.shape is None or dataset.is_virtual or dataset.external:
            return False
        plist = dataset.id.get_create_plist()
        filters = {plist.get_filter(i)[0] for i in range(plist.get_nfilters())}
        if not filters <= _FILTERS:
            return False
        if dataset.chunks:
            # A chunk is unpacked whole, however little of it belongs to the data.
            chunk = math.prod(dataset.chunks) * dataset.dtype.itemsize
            unpacked = chunk * dataset.id.get_num_chunks()
            if chunk > min(_MOST_CHUNK, self._most) or unpacked > self._left:
                return False
            self._left -= max(0, unpacked - dataset.nbytes)
        return bool(filters) or dataset.id.get_storage_size() >= dataset.nbytes

    def _take(self, wanted: int) -> None:
        """Count bytes that will be held; raise ForeignFileError before they are too many."""
        self._left -= wanted
        if self._left < 0:
            raise ForeignFileError(
                f"{self._origin}: wanted at most {self._most // 10**6} MB of numbers and texts in "
                "a file of this size, got more; split the file, or save it uncompressed"
            )

    def _numbers(self, dataset: Any) -> npt.NDArray[Any] | None:
        dtype = dataset.dtype
        parts = next((p for p in _PARTS if dtype.names == p), None)
        fields = [dtype[name] for name in parts] if parts else [dtype]
        if any(one.kind not in "fiucb" or one.itemsize > 16 for one in fields):
            return None
        if not self._readable(dataset) or dataset.ndim > 4:
            return None
        width = 16 if parts or dtype.kind == "c" else 8
        self._take(math.prod(dataset.shape) * width)
        raw = np.asarray(dataset[()])
        if parts:
            raw = raw[parts[0]] + 1j * raw[parts[1]]
        values = np.asarray(raw, dtype=np.complex128 if raw.dtype.kind == "c" else np.float64)
        if "MATLAB_class" in dataset.attrs:
            values = values.T  # MATLAB stores columns first
        vector = values.ndim == 2 and 1 in values.shape and values.size > 1
        return values.reshape(-1) if vector else values

    def _words(self, dataset: Any) -> tuple[str, ...] | None:
        """Return texts: strings, MATLAB's characters, or a cell of them; None for no text."""
        if dataset.shape is None or math.prod(dataset.shape) > _MOST_TEXTS:
            return None
        if h5py.check_string_dtype(dataset.dtype) is not None:
            if not self._readable(dataset):
                return None
            self._take(dataset.nbytes)
            items = np.asarray(dataset[()]).reshape(-1)
            return tuple(_text(item) for item in items)
        kind = _text(dataset.attrs.get("MATLAB_class", b""))
        if kind == "char" and dataset.dtype == np.uint16 and self._readable(dataset):
            self._take(dataset.nbytes)
            codes = np.asarray(dataset[()]).T.reshape(-1)
            return ("".join(map(chr, codes.tolist())).strip(),)
        if kind == "cell" and h5py.check_ref_dtype(dataset.dtype) is h5py.Reference:
            members = [self._file[ref] for ref in np.asarray(dataset[()]).reshape(-1) if ref]
            found = [
                self._words(one)
                for one in members
                if isinstance(one, h5py.Dataset) and one.dtype == np.uint16
            ]
            return tuple(words[0] for words in found if words) or None
        return None


def _text(item: Any) -> str:
    if isinstance(item, bytes):
        return item.decode("utf-8", "replace").strip("\0 ")
    return str(item).strip("\0 ")
