"""A file format of another program: how it is recognised, and what reads it."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from armodal.protocols.foreign import formats
from armodal.protocols.foreign.meaning import content_of
from armodal.protocols.foreign.measured import Content, Hints
from armodal.protocols.foreign.variables import Variables

__all__ = ["HEAD_BYTES", "FileFormat", "every_format", "of_bytes"]

HEAD_BYTES = 2048  # as much of a file as its format is recognised by

Read = Callable[[Path, bytes, Hints], Content]
Arrays = Callable[[Path, bytes], Sequence[Variables]]


@dataclass(frozen=True, slots=True, kw_only=True)
class FileFormat:
    """A format that a module of `protocols.foreign.formats` offers as `FORMAT`.

    name
        As people know it.
    holds
        What is read of it, in one sentence, for the page of formats.
    endings
        Of file names, lower case; they tell where the first bytes are damaged.
    is_it
        Whether the first `HEAD_BYTES` of a file are of this format.
    variables
        From path and all bytes to the named arrays in the file.
    own_read
        From path, all bytes and what is told beside them to the measurements in the file, where the
        format says itself what its arrays mean; else that is found as for every format.
    """

    name: str
    holds: str
    endings: tuple[str, ...]
    is_it: Callable[[bytes], bool]
    variables: Arrays
    own_read: Read | None = None

    def read(self, path: Path, data: bytes, hints: Hints) -> Content:
        """Return the measurements in a file of this format."""
        if self.own_read is not None:
            return self.own_read(path, data, hints)
        return content_of(self.variables(path, data), hints, path.name)


def of_bytes(read: Callable[[bytes, str], Sequence[Variables]]) -> Arrays:
    """Return a reader of named arrays by one that takes bytes and the file's name."""
    return lambda path, data: read(data, path.name)


@lru_cache(maxsize=1)
def every_format() -> tuple[FileFormat, ...]:
    """Return what the modules of `protocols.foreign.formats` offer, by name."""
    found = pkgutil.iter_modules(formats.__path__)
    modules = [importlib.import_module(f"{formats.__name__}.{module.name}") for module in found]
    return tuple(sorted((module.FORMAT for module in modules), key=lambda own: str(own.name)))
