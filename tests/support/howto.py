"""What a how-to shows: whole files, each under its path, and changes of files that are there."""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["changed", "changes_shown", "files_shown"]

PAGES = Path(__file__).parents[2] / "docs" / "howto"
_FILE = re.compile(
    r"^```(?:python|toml)\n# (\S+\.(?:py|toml))\n(.*?)^```$", re.MULTILINE | re.DOTALL
)
_CHANGE = re.compile(r"^```diff\n\+\+\+ (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def files_shown(page: str) -> dict[str, str]:
    """Return every whole file of a page, by its path in the project."""
    return dict(_FILE.findall((PAGES / f"{page}.md").read_text(encoding="utf-8")))


def changes_shown(page: str) -> dict[str, str]:
    """Return the lines added to files that are there, by the path of each."""
    return dict(_CHANGE.findall((PAGES / f"{page}.md").read_text(encoding="utf-8")))


def changed(text: str, change: str) -> str:
    """Return a file with a change: hunks behind `@@`, added lines with `+`, the others as they are.

    Raises
    ------
    ValueError
        If the lines of a hunk that are not added stand at no place or at several.
    """
    for hunk in change.split("@@\n")[1:]:
        lines = hunk.splitlines(keepends=True)
        there = "".join(line[1:] for line in lines if line[0] == " ")
        if text.count(there) != 1:
            raise ValueError(f"{text.count(there)} places have the lines\n{there}")
        text = text.replace(there, "".join(line[1:] or line for line in lines))
    return text
