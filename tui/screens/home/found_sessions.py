"""Sessions in a folder and in the folders within it, newest first."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from armodal.protocols.session.hdf5 import is_complete

__all__ = ["FoundSession", "find_sessions", "new_journal"]

MOST = 20  # shown; older ones are opened by their name


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundSession:
    """A session file to look at, or a journal to go on with."""

    path: Path
    changed: datetime
    unfinished: Path | None  # journal that the session can be gone on with


def find_sessions(folder: Path) -> tuple[FoundSession, ...]:
    """Return the newest sessions; files that are no sessions, or cannot be read, are left out."""
    found = []
    for path in (*folder.glob("*"), *folder.glob("*/*")):
        journal = path.with_suffix(".journal")
        try:
            if path.suffix == ".h5":
                complete = is_complete(path)
                if complete is None:
                    continue
                unfinished = journal if not complete and journal.is_file() else None
            elif path.suffix == ".journal" and not path.with_suffix(".h5").exists():
                unfinished = path
            else:
                continue
            changed = datetime.fromtimestamp(path.stat().st_mtime).astimezone()
        except OSError:
            continue
        found.append(FoundSession(path=path, changed=changed, unfinished=unfinished))
    return tuple(sorted(found, key=lambda one: one.changed, reverse=True)[:MOST])


def new_journal(folder: Path) -> Path:
    """Return a name for a journal that is not there yet."""
    names = ["session", *(f"session-{number}" for number in range(2, 10_000))]
    return next(
        path
        for name in names
        if not (path := folder / f"{name}.journal").exists()
        and not path.with_suffix(".h5").exists()
    )
