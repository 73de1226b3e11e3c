"""Members of an HDF5 file written plainly and read as if a stranger had written them.

Written: fixed-length UTF-8 strings, little-endian numbers, contiguous, no links but hard ones.
Read: nothing else, and nothing before its size is known. Attributes are written for viewers and
never read back. HDF5 itself makes room for what a file says, so it is bounded meanwhile.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import h5py
import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import SessionError
from armodal.protocols.hdf5_heap import has_endless_heap
from armodal.protocols.hdf5_superblock import names_a_driver
from armodal.protocols.hdf5_virtual import has_virtual_dataset
from armodal.protocols.memory_bound import at_most_more

__all__ = [
    "Tree",
    "add_array",
    "add_group",
    "add_text",
    "add_texts",
    "open_tree",
]

MAX_TEXT = 8 * 2**20  # bytes of one text
MAX_STRING = 2**20  # bytes of one string of a list
MAX_ROWS = 200_000
_ALLOWED_FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE}
_BUDGET_FLOOR = 16 * 2**20
_BUDGET_FACTOR = 100  # bytes read at most, per byte of the file: what repacking may compress
_BUDGET_CEILING = 2**32
_LIBRARY_BYTES = 64 * 2**20  # that HDF5 may take besides, for what it knows of a file and a chunk
_HDF5_ERRORS = (OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError, MemoryError)


def add_group(parent: h5py.Group, name: str, nx_class: str, **attributes: object) -> h5py.Group:
    """Create a group of a NeXus class with further attributes."""
    group = parent.create_group(name)
    group.attrs["NX_class"] = nx_class
    for key, value in attributes.items():
        group.attrs[key] = value
    return group


def add_array(
    parent: h5py.Group, name: str, values: npt.NDArray[Any], **attributes: str
) -> h5py.Dataset:
    """Create a dataset of little-endian numbers."""
    data = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    dataset = parent.create_dataset(name, data=data.reshape(values.shape))
    for key, value in attributes.items():
        dataset.attrs[key] = value
    return dataset


def add_text(parent: h5py.Group, name: str, text: str) -> None:
    """Create a scalar text."""
    data = text.encode()
    dtype = h5py.string_dtype("utf-8", max(len(data), 1))
    parent.create_dataset(name, data=np.array(data, dtype=dtype))


def add_texts(parent: h5py.Group, name: str, texts: Sequence[str]) -> None:
    """Create a list of strings."""
    data = [text.encode() for text in texts]
    dtype = h5py.string_dtype("utf-8", max((len(item) for item in data), default=1) or 1)
    parent.create_dataset(name, data=np.array(data, dtype=dtype), shape=(len(data),))


@contextmanager
def open_tree(path: Path) -> Iterator[Tree]:
    """Open an HDF5 file for reading; whatever HDF5 refuses becomes one SessionError."""
    try:
        _check_bytes(path)
        with at_most_more(_LIBRARY_BYTES):
            file = h5py.File(path, "r", locking="best-effort")
        with file:
            yield Tree(file, path)
    except SessionError:
        raise
    except FileNotFoundError:
        raise SessionError(
            f"there is no session file {path}: give the path of a .h5 file that armodal wrote"
        ) from None
    except _HDF5_ERRORS as error:
        raise SessionError(
            f"{path} cannot be read: wanted a session file that armodal wrote, found something "
            f"else or a damaged one; {_way_out(path)}"
        ) from error


def _check_bytes(path: Path) -> None:
    """Raise before HDF5 opens what it would go round in, or what would crash it."""
    if has_endless_heap(path) or names_a_driver(path):
        raise OSError("a heap without end, or a driver's block")
    if has_virtual_dataset(path):
        raise SessionError(
            f"{path}: wanted a session with its data in this file, data in another file came; the "
            "file is damaged or was not written by armodal: rebuild it from its journal with "
            "`armodal recover`"
        )


class Tree:
    """A checked view of one group; sub-groups share the budget of bytes still to be read."""

    def __init__(self, group: h5py.Group, path: Path, budget: list[int] | None = None) -> None:
        self._group = group
        self._path = path
        if budget is None:
            size = path.stat().st_size
            budget = [min(_BUDGET_CEILING, _BUDGET_FLOOR + _BUDGET_FACTOR * size)]
        self._budget = budget

    def refuse(self, name: str, wanted: str, came: str) -> NoReturn:
        """Raise SessionError about the member called `name`."""
        place = f"{self._group.name.rstrip('/')}/{name}"
        raise SessionError(
            f"{self._path}: {place}: wanted {wanted}, {came} came; the file is damaged or was not "
            "written by armodal: rebuild it from its journal with `armodal recover`"
        )

    def has(self, name: str) -> bool:
        """Return whether a member of that name is there, whatever it is."""
        return name in self._group.keys()  # noqa: SIM118 - `in group` would follow a soft link

    def group(self, name: str) -> Tree:
        """Return the sub-group called `name`."""
        return Tree(self._member(name, h5py.Group, "a group"), self._path, self._budget)

    def array(
        self,
        name: str,
        dtype: npt.DTypeLike,
        shape: tuple[int | None, ...],
        *,
        limit: int = MAX_ROWS,
    ) -> npt.NDArray[Any]:
        """Return numbers of exactly `dtype` and `shape`; None stands for 0 to `limit`."""
        wanted = np.dtype(dtype).newbyteorder("<")
        dataset = self._dataset(name)
        words = f"{wanted.name} of shape {_shape_words(shape)}"
        if dataset.dtype != wanted or dataset.shape is None or len(dataset.shape) != len(shape):
            self.refuse(name, words, f"{dataset.dtype} of shape {dataset.shape}")
        for is_, should in zip(dataset.shape, shape, strict=True):
            if is_ != should and not (should is None and is_ <= limit):
                self.refuse(name, words, f"shape {dataset.shape}")
        return self._read(name, dataset)

    def finite(self, name: str, shape: tuple[int | None, ...]) -> npt.NDArray[np.float64]:
        """Return float64 numbers, all finite."""
        values = self.array(name, np.float64, shape)
        if not np.isfinite(values).all():
            self.refuse(name, "finite numbers", "NaN or infinity")
        return values

    def integer(self, name: str, low: int, high: int) -> int:
        """Return a scalar int64 from `low` to `high`."""
        value = int(self.array(name, np.int64, ()))
        if not low <= value <= high:
            self.refuse(name, f"a number from {low} to {high}", str(value))
        return value

    def flags(self, name: str, shape: tuple[int | None, ...]) -> npt.NDArray[np.bool_]:
        """Return truth values, stored as 0 and 1."""
        values = self.array(name, np.uint8, shape)
        if (values > 1).any():
            self.refuse(name, "zeros and ones", str(values.max()))
        return values.astype(np.bool_)

    def text(self, name: str, *, limit: int = MAX_TEXT) -> str:
        """Return a scalar text of at most `limit` bytes."""
        return self._strings(name, (), limit)[0]

    def texts(self, name: str, count: int | None = None) -> tuple[str, ...]:
        """Return a list of `count` strings (None: any number of them)."""
        return self._strings(name, (count,), MAX_STRING)

    def _strings(self, name: str, shape: tuple[int | None, ...], limit: int) -> tuple[str, ...]:
        dataset = self._dataset(name)
        info = h5py.check_string_dtype(dataset.dtype)
        if info is None or info.length is None or info.length > limit:
            self.refuse(name, f"fixed-length strings up to {limit} bytes", str(dataset.dtype))
        if dataset.shape is None or len(dataset.shape) != len(shape):
            self.refuse(name, f"shape {_shape_words(shape)}", str(dataset.shape))
        for is_, should in zip(dataset.shape, shape, strict=True):
            if is_ != should and not (should is None and is_ <= MAX_ROWS):
                self.refuse(name, f"shape {_shape_words(shape)}", str(dataset.shape))
        try:
            return tuple(bytes(item).decode() for item in np.ravel(self._read(name, dataset)))
        except UnicodeDecodeError as error:
            self.refuse(name, "UTF-8", str(error))

    def _dataset(self, name: str) -> h5py.Dataset:
        dataset = self._member(name, h5py.Dataset, "a dataset")
        if dataset.is_virtual or dataset.external:
            self.refuse(name, "data in this file", "data in another file")
        plist = dataset.id.get_create_plist()
        filters = {plist.get_filter(i)[0] for i in range(plist.get_nfilters())}
        if not filters <= _ALLOWED_FILTERS:
            self.refuse(name, "no filter but gzip and shuffle", f"filters {sorted(filters)}")
        if not filters and dataset.shape and dataset.id.get_storage_size() < dataset.nbytes:
            self.refuse(name, f"{dataset.nbytes} bytes stored", str(dataset.id.get_storage_size()))
        return dataset

    def _member(self, name: str, wanted: type, words: str) -> Any:
        if not self.has(name):
            self.refuse(name, words, "nothing")
        link = self._group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            self.refuse(name, f"{words} in place", f"a {type(link).__name__}")
        with at_most_more(_LIBRARY_BYTES):
            found = self._group.get(name, getclass=True)
            member = self._group[name]
        if found is not wanted:
            self.refuse(name, words, f"a {found.__name__.lower()}")
        return member

    def _read(self, name: str, dataset: h5py.Dataset) -> npt.NDArray[Any]:
        size = math.prod(dataset.shape) * dataset.dtype.itemsize
        self._budget[0] -= size
        if self._budget[0] < 0:
            self.refuse(name, "at most 100 times the file's size in all", f"{size} bytes more")
        with at_most_more(size + _LIBRARY_BYTES):
            return np.asarray(dataset[()])


def _shape_words(shape: tuple[int | None, ...]) -> str:
    return "(" + ", ".join("n" if size is None else str(size) for size in shape) + ")"


def _way_out(path: Path) -> str:
    journal = path.with_suffix(".journal")
    if journal.is_file():
        return f"`armodal recover {journal}` builds it anew"
    return "give the path of a .h5 file of a session (`armodal import` takes other programs' files)"
