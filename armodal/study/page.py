"""A study's tables as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.study.tables import StudyTable

__all__ = ["as_markdown", "study_page"]


def study_page(tables: Sequence[StudyTable], command: str, commit: str = "") -> str:
    """Return the page.

    Parameters
    ----------
    command
        That made it, seeds and all.
    commit
        That was judged, of an official study.
    """
    parts = ["# Tables of the gap study", f"Made by\n\n    {command}"]
    if commit:
        parts.append(f"at commit {commit}, which gave the seed.")
    for table in tables:
        parts += [f"## {table.title}", *([table.note] if table.note else []), as_markdown(table)]
    return "\n\n".join(parts) + "\n"


def as_markdown(table: StudyTable) -> str:
    """Return a table as lines of Markdown."""
    lines = [table.head, ("---",) * len(table.head), *table.rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
