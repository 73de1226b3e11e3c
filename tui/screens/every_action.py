"""Every key of a screen as a line of the command palette."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

from textual.app import App, SystemCommand
from textual.screen import Screen

__all__ = ["every_action"]


def every_action(app: App[Any], screen: Screen[Any]) -> Iterable[SystemCommand]:
    """Yield what a key of the screen in use does now, once each, with the key that does it."""
    seen = set()
    # Of several keys for one action that of the line of keys, which comes with the app's own word.
    active = sorted(screen.active_bindings.values(), key=lambda found: not found.binding.show)
    for node, binding, enabled, _ in active:
        if not enabled or not binding.description or binding.action in seen:
            continue
        seen.add(binding.action)
        words = binding.description[0].upper() + binding.description[1:]
        yield SystemCommand(
            words,
            f"key {app.get_key_display(binding)}",
            partial(app.run_action, binding.action, node),
        )
