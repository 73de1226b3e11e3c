"""The answer to a key that does nothing: which keys do something now."""

from __future__ import annotations

from typing import Any

from textual import events
from textual.screen import Screen

from armodal.tui.screens.key_line import KeyLine

__all__ = ["key_answer"]


def key_answer(event: events.Key, screen: Screen[Any]) -> str:
    """Return what to say about a key; empty where it did something, or a dialogue has the keys."""
    if event.key in screen.active_bindings:
        return ""
    for line in screen.query(KeyLine):
        written = event.character if event.is_printable else event.key
        return f"{written} does nothing here. These keys do: {line.words}."
    return ""
