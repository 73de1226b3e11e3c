"""Help: what the keys do, in the order they are needed."""

from __future__ import annotations

from collections.abc import Iterable

from textual import events
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

__all__ = ["HelpScreen"]

WORDS = """\
[b]How a session goes[/b]
 Lab       see that board, controller and sensors are well; Enter confirms, Enter begins
 Posture   bring the arm to its posture; it goes on by itself once the arm is still
           Enter says that the arm is held and safe to approach
 Point     mount the sensor as shown; Enter says that it is ready
 Hit       hit until the point has its hits; only "ACCEPTED" counts, it is in the journal

[b]Keys[/b]
 Enter  go on, as the screen says       h  the simulated hand does what is asked
 t      start the point over            k  skip the point
 u      take the last accepted hit back g  progress; arrows and Enter jump to a point
 e      type the joint angles read, where no device tells them
 m      move the point in hand, before its first accepted hit
 s      simulated laboratory            a  take the suggested trigger level
 c      calibrate hammer and accelerometer on a known mass
 r      try again after a stop          b  bell at every verdict
 q      leave: come back with the same command, it goes on at the same point
 ctrl+p all commands and themes
{more}
Closing the window, or killing this program, loses no hit: another process measures.
Any key closes this help.
"""


class HelpScreen(ModalScreen[None]):
    """Over whatever is shown.

    Parameters
    ----------
    more
        Further keys, and what they do.
    """

    def __init__(self, more: Iterable[tuple[str, str]] = ()) -> None:
        super().__init__()
        self._more = "".join(f" {key:6} {words.lower()}\n" for key, words in more)

    def compose(self) -> ComposeResult:
        """The words."""
        with VerticalScroll(id="help"):
            yield Static(WORDS.format(more=self._more))

    def on_key(self, event: events.Key) -> None:
        """Go back."""
        event.stop()  # it is no key of the screen beneath
        self.dismiss()
