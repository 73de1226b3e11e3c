"""The keys that do something now, in one line; a click on one presses it."""

from __future__ import annotations

from typing import ClassVar

from rich.cells import cell_len
from rich.text import Text
from textual import events
from textual.screen import Screen
from textual.widget import Widget

__all__ = ["KeyLine"]

_ALWAYS = ("help", "leave")  # help names every key


def _width(key: tuple[str, str, str]) -> int:
    return cell_len(f"{key[1]} {key[2]} ")


class KeyLine(Widget, can_focus=False):
    """One widget for all keys: drawn again when they change, never composed anew.

    Textual's footer composes a widget for each key at every change, and its watchers keep the old
    ones alive (Textualize/textual#6666): over a session the garbage collector gets slow by them.
    """

    ALLOW_SELECT = False
    COMPONENT_CLASSES: ClassVar[set[str]] = {"key-line--key"}
    DEFAULT_CSS = """
    KeyLine {
        dock: bottom;
        height: 1;
        color: $footer-foreground;
        background: $footer-background;
        .key-line--key {
            color: $footer-key-foreground;
            background: $footer-key-background;
            text-style: bold;
        }
    }
    """

    def __init__(self) -> None:
        super().__init__()
        self._keys: tuple[tuple[str, str, str], ...] = ()  # key, how it is written, what it does

    def on_mount(self) -> None:
        """Follow the keys of the screen."""
        self.screen.bindings_updated_signal.subscribe(self, self._look)

    def on_unmount(self) -> None:
        """Follow them no more."""
        self.screen.bindings_updated_signal.unsubscribe(self)

    def _look(self, screen: Screen[object]) -> None:
        first: dict[str, tuple[str, str, str]] = {}
        for _, binding, enabled, _ in screen.active_bindings.values():
            if binding.show and enabled:
                words = (binding.key, self.app.get_key_display(binding), binding.description)
                first.setdefault(binding.action, words)
        keys = tuple(first.values())
        if keys != self._keys:
            self._keys = keys
            self.refresh()

    @property
    def words(self) -> str:
        """The keys and what they do, as a list in a sentence."""
        return ", ".join(f"{written} {does}" for _, written, does in self._keys)

    def render(self) -> Text:
        """Return the line; where it is too long, the last keys before help and leave give way."""
        style = self.get_component_rich_style("key-line--key")
        text = Text(no_wrap=True, overflow="crop")
        for _, written, does in self._fitting():
            text.append(written, style=style).append(f" {does} ")
        return text

    def _fitting(self) -> tuple[tuple[str, str, str], ...]:
        first = [one for one in self._keys if one[2].lower() not in _ALWAYS]
        last = [one for one in self._keys if one[2].lower() in _ALWAYS]
        while first and sum(_width(one) for one in (*first, *last)) > self.size.width + 1:
            first.pop()
        return (*first, *last)

    def on_click(self, event: events.Click) -> None:
        """Press the key that was clicked."""
        end = 0
        for key, written, does in self._fitting():
            end += _width((key, written, does))
            if event.x < end:
                self.app.simulate_key(key)
                return
