"""Poles picked by hand, kept in a file of their own beside the session."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

from armodal.protocols.errors import SessionError
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text

__all__ = ["picked_path", "read_picked", "write_picked"]

_FORMAT = "armodal-picked-poles-1"
_LIMIT = 1024 * 1024


def picked_path(session: Path) -> Path:
    """Where the picks of a session file are kept."""
    return session.with_suffix(".picked.json")


def write_picked(path: Path, session: Session, picks: Mapping[str, tuple[complex, ...]]) -> None:
    """Write picked poles (rad/s) by posture; the file is whole or as it was before.

    Raises
    ------
    SessionError
        If it cannot be written.
    """
    value = {
        "format": _FORMAT,
        "session_id": session.header.session_id,
        "postures": {
            name: [
                {"f_hz": abs(pole) / (2 * math.pi), "damping_ratio": -pole.real / abs(pole)}
                for pole in poles
            ]
            for name, poles in picks.items()
        },
    }
    replace_text(path, json.dumps(value, indent=2) + "\n")


def read_picked(path: Path, session: Session) -> dict[str, tuple[complex, ...]]:
    """Read picked poles (rad/s) by posture; an absent file holds none.

    Raises
    ------
    SessionError
        If the file is not of this session or not readable as one.
    """
    if not path.exists():
        return {}
    if path.stat().st_size > _LIMIT:
        raise SessionError(f"{path} is over {_LIMIT} bytes; move it away to go on without")
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
        told, belongs_to = value["format"], value["session_id"]
        picks = {
            name: tuple(_pole(row["f_hz"], row["damping_ratio"]) for row in rows)
            for name, rows in value["postures"].items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise SessionError(
            f"{path}: wanted {_FORMAT}, got something else ({error}); move it away to go on without"
        ) from error
    if told != _FORMAT:
        raise SessionError(f"{path}: wanted {_FORMAT}, got {told}; move it away to go on without")
    if belongs_to != session.header.session_id:
        raise SessionError(
            f"{path} belongs to session {belongs_to}, this is {session.header.session_id}; "
            "move it away to go on without"
        )
    return picks


def _pole(f_hz: float, damping_ratio: float) -> complex:
    if not (f_hz > 0.0 and 0.0 < damping_ratio < 1.0 and math.isfinite(f_hz)):
        raise ValueError(f"a pole of {f_hz} Hz and damping {damping_ratio}")
    omega = 2 * math.pi * f_hz
    return complex(-damping_ratio * omega, math.sqrt(1.0 - damping_ratio**2) * omega)
