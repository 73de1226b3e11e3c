"""Folders of laboratories: made for one, and cleaned up after those that were killed."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from pathlib import Path

__all__ = ["new_lab_folder"]

_NAME = re.compile(r"armodal-lab-(?P<pid>[0-9]+)-[^/]+")


def new_lab_folder() -> Path:
    """Return a new folder of this process; those of processes that have gone are removed.

    Who is killed cannot clean up. A folder tells by its name which process made it; it stays while
    there is a process of that number, and where it belongs to somebody else.
    """
    for folder in Path(tempfile.gettempdir()).glob("armodal-lab-*"):
        if _is_abandoned(folder):
            shutil.rmtree(folder, ignore_errors=True)
    return Path(tempfile.mkdtemp(prefix=f"armodal-lab-{os.getpid()}-"))


def _is_abandoned(folder: Path) -> bool:
    named = _NAME.fullmatch(folder.name)
    try:
        if named is None or folder.is_symlink() or folder.stat().st_uid != os.getuid():
            return False
        os.kill(int(named["pid"]), 0)  # asks whether it is there
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):  # gone meanwhile, somebody else's, or no number of a process
        return False
    return False
