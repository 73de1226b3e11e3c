"""The session file, derived from the journal with its FRFs."""

from __future__ import annotations

from pathlib import Path

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.protocols.session.recovery import rebuild

__all__ = ["derive_session_file"]


def derive_session_file(journal: Path, session_file: Path, software: str) -> None:
    """Write the session file; JournalError, SessionError or OSError if that cannot be done."""
    rebuild(
        journal,
        session_file,
        software=software,
        estimate_frfs=lambda session: estimate_frfs(session, Superset(session.header.arm)),
    )
