"""A file to write, looked at before the work that fills it."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.errors import SessionError

__all__ = ["check_output"]


def check_output(path: Path, *read: Path) -> None:
    """Refuse a path that cannot take a result, or is one of the files that are read.

    Raises
    ------
    SessionError
        If it is a folder, its folder is not there, or it is one of `read`, by whatever name.
    """
    if path.is_dir():
        raise SessionError(f"wanted a file to write, got the folder {path}; give a name in it")
    if not path.parent.is_dir():
        raise SessionError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    for source in read:
        if path.exists() and source.exists() and path.samefile(source):
            raise SessionError(
                f"wanted another file to write than what is read, got {path} for both; it is left "
                "as it is: give the output another name"
            )
