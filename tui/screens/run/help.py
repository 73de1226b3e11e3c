"""Help: how a session goes, and what the keys do."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import zip_longest

from rich.markup import escape
from textual import events
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

__all__ = ["HelpScreen"]

WORDS = """\
[b]How a session goes[/b]
 Lab      see that every device is well; Enter confirms, Enter begins
 Posture  bring the arm to its posture; Enter says that it is held and safe
 Point    mount the sensor as shown; Enter says that it is ready
 Hit      hit until the point has its hits; only "ACCEPTED" counts

[b]Keys[/b]
{keys}
 arrows at a point: walk around the arm; in the grid: choose a point
 ctrl+p all commands and themes

Closing the window, or killing this program, loses no hit: another process measures.
Any key closes this help.
"""


class HelpScreen(ModalScreen[None]):
    """Over whatever is shown.

    Parameters
    ----------
    keys
        Every key as it is written, and what it does; two stand in a line.
    """

    def __init__(self, keys: Iterable[tuple[str, str]]) -> None:
        super().__init__()
        told = [f"{key:3} {words}" for key, words in keys]
        half = (len(told) + 1) // 2
        pairs = zip_longest(told[:half], told[half:], fillvalue="")
        self._keys = escape("\n".join(f" {left:37}{right}".rstrip() for left, right in pairs))

    def compose(self) -> ComposeResult:
        """The words."""
        with VerticalScroll(id="help"):
            yield Static(WORDS.format(keys=self._keys))

    def on_key(self, event: events.Key) -> None:
        """Go back."""
        event.stop()  # it is no key of the screen beneath
        self.dismiss()
