"""What a Textual app shows: its screen as rows of text, its notices as they come."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree as ET

from rich.cells import cell_len
from textual.message import Message
from textual.notifications import Notify

from armodal.tui.screens.key_line import KeyLine

__all__ = ["Notices", "laid_out", "screen_rows", "screen_text", "without_keys"]

LAID_OUT_S = 30.0

SVG = "{http://www.w3.org/2000/svg}"


class Notices(list[str]):
    """The messages of an app's notices; to be given to `run_test` as its `message_hook`."""

    def __call__(self, message: Message) -> None:
        if isinstance(message, Notify):
            self.append(message.notification.message)


async def laid_out(pilot: Any, condition: Callable[[], bool]) -> None:
    """Let an app go on until it shows what is wanted: a busy machine needs more than one pause."""
    end = time.monotonic() + LAID_OUT_S
    while not condition():
        assert time.monotonic() < end, screen_text(pilot.app)
        await pilot.pause()


def screen_rows(app: Any) -> list[str]:
    """Return the rows of an app's screen, read from its exported picture.

    The picture holds every stretch of text with its row in the name of its clip path, and its
    place and length along the row in one unit.
    """
    rows = [""] * app.size.height
    for text in ET.fromstring(app.export_screenshot()).iter(f"{SVG}text"):  # noqa: S314 - our own text
        words, clip = text.text or "", text.get("clip-path", "")
        if not clip:  # the title of the picture's frame
            continue
        row = int(clip.rstrip(")").rpartition("-")[2])
        column = round(float(text.get("x", 0)) * len(words) / float(text.get("textLength", 0)))
        gap = column - cell_len(rows[row])
        rows[row] += " " * gap + words.replace("\N{NO-BREAK SPACE}", " ")
    return [row.rstrip() for row in rows]


def screen_text(app: Any) -> str:
    """Return an app's screen as one text."""
    return "\n".join(screen_rows(app))


def without_keys(app: Any) -> list[str]:
    """Return the rows of an app's screen but those that tell what the keys do."""
    keys = [widget.region for widget in app.screen.query(KeyLine)]
    return [
        row
        for y, row in enumerate(screen_rows(app))
        if not any(region.y <= y < region.bottom for region in keys)
    ]
