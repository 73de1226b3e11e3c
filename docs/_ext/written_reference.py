"""Pages of the reference that are written from the code: commands, file formats, effects."""

from __future__ import annotations

from pathlib import Path

from cards import effect_pages
from command_pages import command_pages
from format_page import format_page
from sphinx.application import Sphinx

FOLDER = "reference/written"


def write(app: Sphinx) -> None:
    """Write the pages that changed, and remove those whose subject is gone."""
    folder = Path(app.srcdir) / FOLDER
    pages = {**command_pages(), **format_page(), **effect_pages()}
    for name, text in pages.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.rglob("*.*"):
        if path.relative_to(folder).as_posix() not in pages:
            path.unlink()


def setup(app: Sphinx) -> dict[str, bool]:
    """Write before Sphinx looks for its sources."""
    app.connect("config-inited", lambda app, _config: write(app))
    return {"parallel_read_safe": True}
