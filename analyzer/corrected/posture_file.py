"""Postures of a path from a text file: a line each, joint angles in degrees."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.errors import ArmError
from armodal.protocols.toml_reader import read_text

__all__ = ["read_postures"]

_MOST_LINES = 100_000
_MOST_BYTES = 20_000_000


def read_postures(path: Path, n_joints: int) -> list[list[float]]:
    """Read joint angles in degrees, separated by commas; `#` begins a comment, a head may be first.

    Raises
    ------
    ArmError
        If the file cannot be read, is empty or too long, or has other lines; some are named.
    """
    text = read_text(path, what="postures", limit_bytes=_MOST_BYTES, error=ArmError)
    if text.count("\n") > 2 * _MOST_LINES:  # some may be comments
        raise ArmError(f"{path}: wanted 1 to {_MOST_LINES} lines of joint angles, got many more")
    found: list[list[float]] = []
    wrong: list[str] = []
    for number, line in enumerate(text.splitlines(), start=1):
        own = line.split("#", 1)[0].strip()
        if not own:
            continue
        try:
            angles = [float(part) for part in own.split(",")]
        except ValueError:
            if number > 1:
                wrong.append(f"line {number}: {own[:40]!r}")
            continue
        if len(angles) != n_joints:
            wrong.append(f"line {number}: {len(angles)} numbers")
            continue
        found.append(angles)
    if wrong or not found or len(found) > _MOST_LINES:
        got = "; ".join(wrong[:5]) or f"{len(found)} postures"
        more = f" and {len(wrong) - 5} more" if len(wrong) > 5 else ""
        raise ArmError(
            f"{path}: wanted 1 to {_MOST_LINES} lines of {n_joints} joint angles in degrees, "
            f"separated by commas, got {got}{more}"
        )
    return found
