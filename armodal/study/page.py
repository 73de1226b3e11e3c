"""A study's tables as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.study.tables import StudyTable

__all__ = ["study_page"]


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
        parts += [f"## {table.title}", *([table.note] if table.note else []), _markdown(table)]
    return "\n\n".join(parts) + "\n"


def _markdown(table: StudyTable) -> str:
    lines = [table.head, ("---",) * len(table.head), *table.rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
