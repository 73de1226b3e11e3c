"""Where a mesh's file lies: package://, model://, file:// and plain names.

A package is a folder of that name: one of those given, or one beside a folder that leads to the
description, at any height.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote

__all__ = ["find_mesh", "find_package"]

_HIGHEST = 12  # folders looked in above a description


def find_package(name: str, near: Path, folders: Sequence[Path] = ()) -> Path | None:
    """Return a package's folder, or None.

    Parameters
    ----------
    near
        The folder of the description.
    folders
        Folders to look in first: packages themselves, or what holds packages.
    """
    for folder in _places(near, folders):
        if folder.name == name and folder.is_dir():
            return folder
        if (folder / name).is_dir():
            return folder / name
    return None


def find_mesh(named: str, near: Path, folders: Sequence[Path] = ()) -> Path | None:
    """Return the file a description names, or None.

    Of a package that is not there by its name, the file is looked for as if the description's own
    folders were the package, since published folders are often renamed.
    """
    scheme, mark, rest = named.partition("://")
    if not mark:
        scheme, rest = "", named
    rest = unquote(rest)
    if scheme == "file":
        return _file(Path(rest))
    if scheme in {"package", "model"}:
        package, _, inside = rest.partition("/")
        home = find_package(package, near, folders)
        if home is not None:
            return _file(home / inside)
        return next(filter(None, (_file(place / inside) for place in _places(near, folders))), None)
    if Path(rest).is_absolute():
        return _file(Path(rest))
    return next(filter(None, (_file(place / rest) for place in (near, *folders))), None)


def _places(near: Path, folders: Sequence[Path]) -> Iterator[Path]:
    yield from folders
    here = near.resolve()
    yield here
    yield from list(here.parents)[:_HIGHEST]


def _file(path: Path) -> Path | None:
    try:
        return path if path.is_file() else None
    except (OSError, ValueError):
        return None
