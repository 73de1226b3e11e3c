"""What a screen shows, kept as text: a change of any character has to be meant.

The line of keys is left out, so that another key does not change every screen.
`ARMODAL_SNAPSHOTS=write` writes the files anew; look at what git says has changed.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from support.screen import without_keys

__all__ = ["assert_as_kept"]


def assert_as_kept(app: Any, path: Path) -> None:
    """Compare the screen with the text kept of it."""
    shown = "\n".join(without_keys(app)) + "\n"
    if os.environ.get("ARMODAL_SNAPSHOTS") == "write":
        path.parent.mkdir(exist_ok=True)
        path.write_text(shown, encoding="utf-8")
    assert path.exists(), f"no text is kept of this screen; write {path.name} and look at it"
    assert shown == path.read_text(encoding="utf-8")
