"""What every screen has: a title, the safety line, the loss counters, the keys."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.css.query import NoMatches
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from armodal.tui.screens.key_line import KeyLine
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.views.parts import losses_text, safety_text, title

__all__ = ["Pane", "StepScreen"]

LEAST_COLUMNS, LEAST_ROWS = 60, 18


class Pane(Static):
    """Text that is drawn again only when it has changed."""

    def __init__(self, *, id: str) -> None:  # noqa: A002 - Textual's own name for it
        super().__init__("", id=id)
        self._shown: Text | None = None

    def show(self, text: Text) -> None:
        """Show text."""
        if self._shown is None or text != self._shown or text.spans != self._shown.spans:
            self._shown = text
            # Where the text does not make the size, nothing else has to move.
            self.update(text, layout=self.styles.auto_dimensions)

    @property
    def room(self) -> tuple[int, int]:
        """Columns and rows of the content."""
        return self.content_size.width, self.content_size.height

    @property
    def plain(self) -> str:
        """The characters shown."""
        return self._shown.plain if self._shown is not None else ""


class StepScreen(Screen[None]):
    """A screen of the session: subclasses compose `body` and fill it in `draw`."""

    def __init__(self) -> None:
        super().__init__()
        self._state: RunState | None = None
        self._composed = False
        self._pictures_due = False

    def compose(self) -> ComposeResult:
        """Title, body, safety and losses, keys."""
        yield Pane(id="title")
        yield Pane(id="too-small")
        with Vertical(id="body"):
            yield from self.body()
        with Horizontal(id="state-line"):
            yield Pane(id="safety")
            yield Pane(id="losses")
        yield KeyLine()

    def body(self) -> ComposeResult:
        """Return the widgets between title and state line."""
        raise NotImplementedError

    def draw(self, state: RunState) -> None:
        """Fill the body."""
        raise NotImplementedError

    def show(self, state: RunState) -> None:
        """Show a state."""
        self._state = state
        if self._composed and self.size.width:  # else it is drawn when it is composed
            self.while_there(lambda: self._fill(state))

    def while_there(self, draw: Callable[[], None]) -> None:
        """Draw, unless the app is being left and the panes are being taken away."""
        with suppress(NoMatches):
            draw()

    def draw_pictures(self, state: RunState) -> None:
        """Draw what takes longer than words."""

    def pictures_later(self) -> None:
        """Have the pictures drawn once the words are on the screen.

        The next refresh may be one that was due before the words came; the one after it has them.
        """
        if not self._pictures_due:
            self._pictures_due = True
            self.call_after_refresh(self.call_after_refresh, self._draw_pictures)

    def _draw_pictures(self) -> None:
        self._pictures_due = False
        state = self._state
        if state is not None and self.is_current and not self.has_class("small"):
            self.while_there(lambda: self.draw_pictures(state))

    def _fill(self, state: RunState) -> None:
        small = self.size.width < LEAST_COLUMNS or self.size.height < LEAST_ROWS
        self.set_class(small, "small")
        self.pane("title").show(title(state, self.size.width))
        safety = safety_text(state)
        self.pane("safety").show(safety)
        self.pane("losses").show(losses_text(state, self.size.width - safety.cell_len - 4))
        if small:
            wanted = f"wanted {LEAST_COLUMNS} x {LEAST_ROWS}"
            here = f"it is {self.size.width} x {self.size.height}"
            words = (
                f"The window is too small: {wanted}, {here}. The measurement goes on meanwhile.\n"
            )
            self.pane("too-small").show(Text(words) + self.brief(state))
            return
        self.draw(state)

    def again(self) -> None:
        """Show the last state once more, after something of the screen's own has changed."""
        if self._state is not None:
            self.show(self._state)

    def on_mount(self) -> None:
        """Draw as soon as the widgets have their sizes."""
        self._composed = True
        self.call_after_refresh(self.again)

    def on_resize(self) -> None:
        """Draw for the new size, once it is known."""
        self.call_after_refresh(self.again)

    def on_screen_resume(self) -> None:
        """Draw what has happened while another screen was on top."""
        self.call_after_refresh(self.again)

    def brief(self, state: RunState) -> Text:
        """Return what is said in a window too small for the screen."""
        del state
        return Text("")

    def pane(self, name: str) -> Pane:
        """Return a pane by its id."""
        return self.query_one(f"#{name}", Pane)

    def widget(self, name: str) -> Widget:
        """Return a widget by its id."""
        return self.query_one(f"#{name}")
