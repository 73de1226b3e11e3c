"""Text files that are written whole: over an older one, or where there is none yet."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.errors import ArmodalError, SessionError
from armodal.protocols.os_words import os_words
from armodal.protocols.whole_file import whole_file

__all__ = ["replace_text", "write_new_text"]


def replace_text(path: Path, text: str) -> None:
    """Write a file whole or not at all; an older one is replaced.

    Raises
    ------
    SessionError
        If that is refused; what was there before is left as it was.
    """
    try:
        with whole_file(path) as file:
            file.write(text.encode())
    except OSError as problem:
        raise SessionError(
            f"cannot write {path}: {os_words(problem)}; check the folder and the disk"
        ) from problem


def write_new_text(path: Path, text: str, *, error: type[ArmodalError]) -> None:
    """Write a file that must not be there yet.

    Raises
    ------
    ArmodalError
        Of type `error`, if there is a file already or it cannot be written.
    """
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise error(f"{path} exists already; give another name") from None
    except OSError as problem:
        raise error(f"cannot write {path}: {os_words(problem)}; check the folder") from problem
