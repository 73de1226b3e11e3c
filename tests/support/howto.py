"""The files that a how-to shows, whole: each block begins with the path of its file."""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["files_shown"]

PAGES = Path(__file__).parents[2] / "docs" / "howto"
_FILE = re.compile(
    r"^```(?:python|toml)\n# (\S+\.(?:py|toml))\n(.*?)^```$", re.MULTILINE | re.DOTALL
)


def files_shown(page: str) -> dict[str, str]:
    """Return every whole file of a page, by its path in the project."""
    return dict(_FILE.findall((PAGES / f"{page}.md").read_text(encoding="utf-8")))
