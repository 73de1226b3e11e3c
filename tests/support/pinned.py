"""The two files of pinned versions, read."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
CONSTRAINTS = ROOT / "constraints.txt"
HASHED = ROOT / "constraints-hashed.txt"


def normalized(name: str) -> str:
    """Return a package's name as an index compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def pinned(path: Path) -> dict[str, tuple[str, frozenset[str]]]:
    """Return version with marker, and hashes, of each package of a constraints file."""
    entries = path.read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
    found = {}
    for entry in entries:
        requirement, *hashes = entry.split("--hash=")
        name, _, version = requirement.partition("==")
        found[normalized(name.strip())] = (
            "".join(version.split()),
            frozenset(one.strip() for one in hashes),
        )
    return found
