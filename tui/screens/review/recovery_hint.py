"""What to do where a session file cannot be shown."""

from __future__ import annotations

from pathlib import Path

__all__ = ["recovery_hint"]


def recovery_hint(session: Path) -> str:
    """Return how the session is rebuilt; empty where no journal lies beside it."""
    journal = session.with_suffix(".journal")
    if not journal.is_file():
        return ""
    return (
        "What was captured is in the journal beside it, which rebuilds the session:\n"
        f"  armodal recover {journal.name}\n\n"
    )
