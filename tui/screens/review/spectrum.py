"""Pictures over frequency: a cursor that moves, a zoom about it, by keys and mouse."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import numpy.typing as npt
from textual import events
from textual.binding import Binding, BindingType

from armodal.tui.drawing import Cursor, Frame, Scale
from armodal.tui.screens.review.picture import Picture
from armodal.tui.screens.review.state import ReviewState

__all__ = ["SpectrumPicture"]

_ABOVE_MODES = 1.5  # the first view ends at this multiple of the highest mode
_ZOOM = 1.6


class SpectrumPicture(Picture):
    """Cursor and zoom over frequency."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "cursor(-1)", "cursor", show=False),
        Binding("right", "cursor(1)", "cursor", show=False),
        Binding("shift+left", "cursor(-10)", "cursor, 10 lines", show=False),
        Binding("shift+right", "cursor(10)", "cursor, 10 lines", show=False),
        Binding("plus,equals_sign", "zoom(1)", "zoom", key_display="+/-"),
        Binding("minus", "zoom(-1)", "zoom out", show=False),
        Binding("0", "whole", "whole band", show=False),
        Binding("n", "mode(1)", "mode"),
        Binding("b", "mode(-1)", "previous mode", show=False),
    ]

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(state, id=id)
        self.cursor_hz: float | None = None
        self.x: Scale | None = None
        self.frame: Frame | None = None  # of the plot the mouse points into

    @property
    def freq_hz(self) -> npt.NDArray[np.float64]:
        """Lines of the posture looked at."""
        return self.state.view.frf.freq_hz

    def x_scale(self) -> Scale:
        """Frequencies shown: up to above the highest mode until somebody zooms."""
        if self.x is not None:
            return self.x
        freq, model = self.freq_hz, self.state.model
        top = float(freq[-1])
        if model is not None and model.modes:
            top = min(top, _ABOVE_MODES * float(model.f_hz.max()))
        return Scale(low=0.0, high=top)

    def cursor_line(self) -> int:
        """Number of the line under the cursor; the chosen mode's when it was never moved."""
        model = self.state.model
        if self.cursor_hz is None and model is not None and model.modes:
            at = model.modes[min(self.state.mode, len(model.modes) - 1)].f_hz
        else:
            at = float(self.freq_hz[0]) if self.cursor_hz is None else self.cursor_hz
        return int(np.argmin(np.abs(self.freq_hz - at)))

    def mode_cursors(self) -> list[Cursor]:
        """Vertical lines at the modes, and one at the cursor."""
        model = self.state.model
        modes = () if model is None else model.modes
        lines = [
            Cursor(
                x=mode.f_hz,
                name=f"{mode.f_hz:.2f}",
                style=self.inks.axis if number == self.state.mode else self.inks.weak,
            )
            for number, mode in enumerate(modes)
        ]
        if self.cursor_hz is not None:
            lines.append(Cursor(x=float(self.freq_hz[self.cursor_line()]), style=self.inks.cursor))
        return lines

    def action_cursor(self, lines: int) -> None:
        """Move the cursor by lines."""
        line = int(np.clip(self.cursor_line() + lines, 0, self.freq_hz.size - 1))
        self.cursor_hz = float(self.freq_hz[line])
        shown = self.x_scale()
        if not bool(shown.holds(self.cursor_hz)):
            span = shown.high - shown.low
            low = max(self.cursor_hz - span / 2, 0.0)
            self.x = Scale(low=low, high=low + span)
        self.redraw()

    def action_zoom(self, way: int) -> None:
        """Zoom about the cursor."""
        about = float(self.freq_hz[self.cursor_line()])
        shown = self.x_scale()
        if not bool(shown.holds(about)):
            about = (shown.low + shown.high) / 2
        zoomed = shown.zoomed(_ZOOM**way, about)
        span = min(zoomed.high, float(self.freq_hz[-1])) - max(zoomed.low, 0.0)
        if span < 6.0 * float(np.min(np.diff(self.freq_hz))):
            return
        self.x = Scale(low=max(zoomed.low, 0.0), high=min(zoomed.high, float(self.freq_hz[-1])))
        self.redraw()

    def action_whole(self) -> None:
        """Show the whole band."""
        self.x = Scale(low=0.0, high=float(self.freq_hz[-1]))
        self.redraw()

    def action_mode(self, step: int) -> None:
        """Look at the next mode."""
        self.cursor_hz = None
        self.state.choose_mode(self.state.mode + step)
        self.redraw()

    def on_click(self, event: events.Click) -> None:
        """Put the cursor where the mouse is."""
        if self.frame is None:
            return
        value = self.frame.value_at(event.x, min(event.y, self.frame.top + self.frame.rows - 1))
        if value is not None:
            self.cursor_hz = value[0]
            self.redraw()

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Zoom in."""
        event.stop()
        self.action_zoom(1)

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Zoom out."""
        event.stop()
        self.action_zoom(-1)
