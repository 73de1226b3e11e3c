"""Measured files by name, and all those of a folder."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.printable import printable

__all__ = ["files_in"]

_MOST_FILES = 10_000  # of a folder: more is no measurement but somebody's disk


def files_in(paths: Sequence[Path]) -> list[Path]:
    """Return the files given, a folder as the files it holds, by name and number.

    Hidden files and folders within are left out.

    Raises
    ------
    ForeignFileError
        If a folder cannot be read, or holds no file or more than a measurement has.
    """
    found: list[Path] = []
    for path in paths:
        found += _within(path) if path.is_dir() else [path]
    return found


def _within(folder: Path) -> list[Path]:
    try:
        own = [p for p in folder.iterdir() if not p.name.startswith(".") and p.is_file()]
    except OSError as error:
        raise ForeignFileError(
            f"{folder}: wanted a folder that can be read, found one that cannot; name its files"
        ) from error
    if not own or len(own) > _MOST_FILES:
        raise ForeignFileError(
            f"{folder}: wanted a folder of up to {_MOST_FILES} measured files, found {len(own)}; "
            "name the files themselves"
        )
    for path in own:
        if "\n" in path.name:
            raise ForeignFileError(
                f"{folder}: wanted names of files on one line, found "
                f"'{printable(path.name, keep='')}'; rename it"
            )
    return sorted(own, key=_by_number)


def _by_number(path: Path) -> list[tuple[int, str]]:
    """Numbers as numbers: point 10 comes after point 9."""
    parts = re.split(r"([0-9]{1,18})", path.name)
    return [(int(part), "") if part.isdecimal() else (-1, part.lower()) for part in parts]
