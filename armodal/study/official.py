"""The seed of an official study: the hash of the commit that is judged.

Nobody can choose it, so nobody can have set a number on its cases.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from armodal.protocols.errors import SessionError

__all__ = ["official_seed"]

_DIGITS = 13  # of the hash: 52 bits


def official_seed(folder: Path) -> tuple[int, str]:
    """Return the seed and the commit it is of.

    Parameters
    ----------
    folder
        In the work tree that holds the code which runs.

    Raises
    ------
    SessionError
        If the code is not of a commit: no work tree, or one with changes.
    """
    commit, changes = _git(folder, "rev-parse", "HEAD"), _git(folder, "status", "--porcelain")
    if commit is None or changes is None:
        raise SessionError(
            "an official study takes its seed from the commit it judges, but this code is in no "
            "git work tree; run it in a clone, or leave out --official"
        )
    if changes:
        raise SessionError(
            "an official study judges a commit, but the work tree has changes "
            f"({len(changes.splitlines())} files); commit or take them out, or leave out --official"
        )
    return int(commit[:_DIGITS], 16), commit


def _git(folder: Path, *words: str) -> str | None:
    try:
        done = subprocess.run(  # noqa: S603 - no shell, and words of ours
            ["git", "-C", str(folder), *words],  # noqa: S607 - git of whoever calls
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None
