"""Text files that are written whole: over an older one, or where there is none yet."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from armodal.protocols.errors import ArmodalError, SessionError

__all__ = ["replace_text", "write_new_text"]


def replace_text(path: Path, text: str) -> None:
    """Write a file whole or not at all; an older one is replaced.

    Raises
    ------
    SessionError
        If that is refused; what was there before is left as it was.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as problem:
        raise SessionError(
            f"cannot write {path}: {problem.strerror}; check the folder and the disk"
        ) from problem
    finally:
        with suppress(OSError):
            part.unlink()


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
        raise error(f"cannot write {path}: {problem.strerror}; check the folder") from problem
