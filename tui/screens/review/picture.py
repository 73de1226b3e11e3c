"""A widget that shows a canvas, painted anew when it changes or is resized."""

from __future__ import annotations

from abc import abstractmethod

from textual.strip import Strip
from textual.widget import Widget

from armodal.tui.drawing import Canvas
from armodal.tui.screens.review.state import ReviewState
from armodal.tui.screens.themes import Inks, inks_of

__all__ = ["Picture"]


class Picture(Widget, can_focus=True):
    """Subclasses paint; everything else is here."""

    DEFAULT_CSS = "Picture { width: 1fr; height: 1fr; }"

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.state = state
        self._strips: list[Strip] = []
        self._painted_size = (-1, -1)
        self.paintings = 0

    @abstractmethod
    def paint(self, columns: int, rows: int) -> Canvas:
        """Draw the picture in that many cells."""

    @property
    def inks(self) -> Inks:
        """Inks of the theme in use."""
        return inks_of(self.app.theme_variables)

    def redraw(self) -> None:
        """Paint again at the next chance."""
        self._painted_size = (-1, -1)
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return one row of the picture."""
        size = (self.size.width, self.size.height)
        if size != self._painted_size:
            # The widget's style is costly to ask for: once a picture, not once a row.
            style = self.rich_style
            self._strips = [row.apply_style(style) for row in self.paint(*size).strips()]
            self._painted_size = size
            self.paintings += 1
        if y >= len(self._strips):
            return Strip.blank(size[0], self.rich_style)
        return self._strips[y]

    def on_mount(self) -> None:
        """Paint again when the theme changes."""
        self.app.theme_changed_signal.subscribe(self, lambda _: self.redraw())
