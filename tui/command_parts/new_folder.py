"""A folder of files that is made whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

from armodal.protocols.errors import ArmError
from armodal.protocols.os_words import os_words

__all__ = ["check_new_folder", "write_new_folder"]


def check_new_folder(folder: Path) -> None:
    """Refuse a folder that is there already, before work is done for it.

    Raises
    ------
    ArmError
        If there is something of that name.
    """
    if folder.exists() or folder.is_symlink():
        raise ArmError(f"{folder} exists already; give another folder with --out")
    if not folder.absolute().parent.is_dir():
        raise ArmError(f"{folder}: wanted a folder in one that exists; make {folder.parent} first")


def write_new_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files by their paths inside a folder that must not be there yet.

    Raises
    ------
    ArmError
        If it is there, or cannot be written; then nothing is left behind.
    """
    check_new_folder(folder)
    part = folder.with_name(f".{folder.name}.{os.getpid()}.part")
    try:
        for name, content in files.items():
            path = part / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        part.rename(folder)
    except OSError as problem:
        raise ArmError(
            f"cannot write {folder}: {os_words(problem)}; check the folder and the disk"
        ) from problem
    finally:
        shutil.rmtree(part, ignore_errors=True)
