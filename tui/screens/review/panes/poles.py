"""The stabilisation diagram: poles over model orders, the chosen ones, picking by hand."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import numpy.typing as npt
from textual import events
from textual.binding import Binding, BindingType
from textual.message import Message

from armodal.analyzer.modal import Stabilisation, cmif, stable_poles
from armodal.tui.drawing import Canvas, Cursor, Frame, Scale, Series, plot, plot_frame
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.spectrum import SpectrumPicture
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PANE", "StabilisationPicture"]

_SAME = 0.005  # of |pole|: picks nearer than this are one
_MOST_DAMPING = 0.5  # poles damped more are not drawn: none of them is a mode


def same_pole(picks: tuple[complex, ...], pole: complex) -> int | None:
    """Return the number of the pick that is this pole, or None."""
    distance = [abs(pick - pole) / abs(pole) for pick in picks]
    if not distance or min(distance) > _SAME:
        return None
    return int(np.argmin(distance))


class StabilisationPicture(SpectrumPicture):
    """Poles of every order; the cursor goes from pole to pole."""

    HELP = """# Stabilisation
Each row is a model order, each mark a pole: `+` where the order before has it too (1 % in
frequency, 5 % in damping), `·` where not. Vertical lines are the poles picked, at first those of
the automatic choice, which looks at narrower bands too: of two close modes it may know both where
this diagram shows one column. Arrows move the cursor from pole to pole, `space` picks or drops
the pole under it, `x` drops the pick nearest to it, `c` drops all, `r` refits the picks, `a` goes
back to the automatic choice, `s` saves the picks beside the session.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "pole(-1)", "pole", show=False),
        Binding("right", "pole(1)", "pole", show=False),
        Binding("up", "order(1)", "order", show=False),
        Binding("down", "order(-1)", "order", show=False),
        Binding("space,enter", "pick", "pick", key_display="space"),
        Binding("x,delete", "drop", "drop", key_display="x"),
        Binding("c", "clear", "drop all", show=False),
        Binding("r", "refit", "refit"),
        Binding("a", "automatic", "auto"),
        Binding("s", "app.save", "save"),
    ]

    class PicksChanged(Message):
        """The picks of the posture looked at are to be these."""

        def __init__(self, picks: tuple[complex, ...]) -> None:
            super().__init__()
            self.picks = picks

    class Refit(Message):
        """The posture looked at is to be refitted from its picks."""

    class Automatic(Message):
        """The posture looked at is to go back to the automatic choice."""

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(state, id=id)
        self._table: Stabilisation | None = None
        self._stable = np.zeros(0, dtype=bool)
        self._shown = np.zeros(0, dtype=np.intp)
        self.pole: int | None = None  # number of the pole under the cursor

    def _poles(self) -> Stabilisation | None:
        """Poles of the posture looked at; those that can be drawn, noted."""
        automatic = self.state.view.automatic
        table = None if automatic is None else automatic.stabilisation
        if table is not self._table:
            self._table = table
            self.pole = None
            if table is not None:
                self._stable = stable_poles(table)
                kept = (table.damping_ratio > 0.0) & (table.damping_ratio < _MOST_DAMPING)
                self._shown = np.flatnonzero(kept)
        if table is not None and self.pole is None and self._shown.size:
            model = self.state.model
            at = model.modes[self.state.mode].f_hz if model is not None and model.modes else 0.0
            top = self._shown[self._stable[self._shown]] if self._stable.any() else self._shown
            cost = np.abs(table.f_hz[top] - at) * 1e3 - table.order[top]
            self.pole = int(top[np.argmin(cost)])
        return table

    def current(self) -> complex | None:
        """Pole under the cursor."""
        table = self._poles()
        return None if table is None or self.pole is None else complex(table.pole_rad_s[self.pole])

    def _go(self, wanted: npt.NDArray[np.bool_], distance: npt.NDArray[np.float64]) -> None:
        table = self._poles()
        if table is None or self.pole is None:
            return
        among = self._shown[wanted[self._shown]]
        if among.size:
            self.pole = int(among[np.argmin(distance[among])])
            at = float(table.f_hz[self.pole])
            shown = self.x_scale()
            if not bool(shown.holds(at)):
                span = shown.high - shown.low
                self.x = Scale(low=max(at - span / 2, 0.0), high=max(at - span / 2, 0.0) + span)
            self.redraw()

    def action_pole(self, way: int) -> None:
        """Go to the next pole of this order."""
        table = self._poles()
        if table is None or self.pole is None:
            return
        ahead = way * (table.f_hz - table.f_hz[self.pole])
        self._go((table.order == table.order[self.pole]) & (ahead > 0.0), ahead)

    def action_order(self, way: int) -> None:
        """Go to the nearest pole of the next order."""
        table = self._poles()
        if table is None or self.pole is None:
            return
        beyond = way * (table.order - table.order[self.pole])
        if not np.any(beyond > 0):
            return
        order = table.order[self.pole] + way * int(beyond[beyond > 0].min())
        self._go(table.order == order, np.abs(table.f_hz - table.f_hz[self.pole]))

    def action_mode(self, step: int) -> None:
        """Go to the next mode's poles."""
        super().action_mode(step)
        self.pole = None
        self.redraw()

    def action_zoom(self, way: int) -> None:
        """Zoom about the pole under the cursor."""
        table = self._poles()
        if table is not None and self.pole is not None:
            self.cursor_hz = float(table.f_hz[self.pole])
        super().action_zoom(way)
        self.cursor_hz = None

    def action_pick(self) -> None:
        """Pick the pole under the cursor, or drop it when it is picked."""
        pole = self.current()
        if pole is None:
            self.app.bell()
            return
        picks = self.state.view.picks
        at = same_pole(picks, pole)
        changed = (*picks, pole) if at is None else (*picks[:at], *picks[at + 1 :])
        self.post_message(self.PicksChanged(tuple(sorted(changed, key=abs))))

    def action_drop(self) -> None:
        """Drop the pick nearest to the cursor in frequency."""
        pole, picks = self.current(), self.state.view.picks
        if pole is None or not picks:
            self.app.bell()
            return
        at = int(np.argmin([abs(abs(pick) - abs(pole)) for pick in picks]))
        self.post_message(self.PicksChanged((*picks[:at], *picks[at + 1 :])))

    def action_clear(self) -> None:
        """Drop all picks."""
        self.post_message(self.PicksChanged(()))

    def action_refit(self) -> None:
        """Ask for a refit."""
        self.post_message(self.Refit())

    def action_automatic(self) -> None:
        """Ask for the automatic choice."""
        self.post_message(self.Automatic())

    def on_click(self, event: events.Click) -> None:
        """Go to the pole nearest to the mouse; a second click there picks it."""
        event.prevent_default()  # the cursor over frequency is not used here
        table = self._poles()
        if table is None or self.frame is None or not self._shown.size:
            return
        frame = self.frame
        at = frame.pixels(table.f_hz[self._shown], table.order[self._shown].astype(np.float64))
        mouse = np.array([2.0 * event.x + 1.0, 4.0 * event.y + 2.0])
        nearest = int(self._shown[np.argmin(((at - mouse) ** 2).sum(axis=1))])
        if nearest == self.pole:
            self.action_pick()
        self.pole = nearest
        self.redraw()

    def paint(self, columns: int, rows: int) -> Canvas:
        """Poles, the CMIF dim beneath, picks as vertical lines."""
        canvas = Canvas(columns, rows)
        table = self._poles()
        if table is None or not table.orders:
            canvas.label(0, 0, self.state.view.problem or "fitting…", "bold")
            return canvas
        x = self.x_scale()
        y = Scale(low=0.0, high=float(max(table.orders)) + 1.0)
        canvas.label(0, 0, self._caption(table), "bold")
        title = "order; + stable, · new pole, │ picked, CMIF dim"
        picture = plot(
            columns,
            rows - 1,
            [self._indicator(x, y), *self._pole_series(table)],
            x=x,
            y=y,
            title=title,
            x_name="Hz",
            cursors=self._pick_cursors(),
        )
        inner = plot_frame(columns, rows - 1, x, y, title=title)
        if self.pole is not None:
            at = inner.pixels([table.f_hz[self.pole]], [float(table.order[self.pole])])
            if bool(x.holds(table.f_hz[self.pole])):
                picture.mark(at, "╋", f"{self.inks.cursor} reverse")
        canvas.paste(picture, 0, 1)
        self.frame = Frame(
            left=inner.left, top=inner.top + 1, columns=inner.columns, rows=inner.rows, x=x, y=y
        )
        return canvas

    def _indicator(self, x: Scale, y: Scale) -> Series:
        freq, values = self.freq_hz, cmif(self.state.view.frf)[:, 0]
        log = np.log(np.maximum(values, np.finfo(float).tiny))
        shown = log[x.holds(freq)]
        low, high = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
        height = (log - low) / max(high - low, 1e-12) * 0.95 * y.high
        return Series(x=freq, y=height, style=self.inks.weak)

    def _pole_series(self, table: Stabilisation) -> list[Series]:
        stable = self._shown[self._stable[self._shown]]
        passing = self._shown[~self._stable[self._shown]]
        return [
            Series(x=table.f_hz[rows], y=table.order[rows], glyph=glyph, style=style)
            for rows, glyph, style in (
                (passing, "·", self.inks.plain),
                (stable, "+", self.inks.strong),
            )
        ]

    def _pick_cursors(self) -> list[Cursor]:
        return [
            Cursor(
                x=abs(pole) / (2.0 * np.pi),
                name=f"{abs(pole) / (2.0 * np.pi):.2f}",
                style=self.inks.axis,
            )
            for pole in self.state.view.picks
        ]

    def _caption(self, table: Stabilisation) -> str:
        if self.pole is None:
            return "no pole in the band"
        pole = complex(table.pole_rad_s[self.pole])
        words = [
            f"pole {table.f_hz[self.pole]:.3f} Hz",
            f"damping {100 * table.damping_ratio[self.pole]:.2f} %",
            f"order {table.order[self.pole]}",
            "stable" if self._stable[self.pole] else "new",
        ]
        if same_pole(self.state.view.picks, pole) is not None:
            words.append("PICKED")
        words.append(f"{len(self.state.view.picks)} picked")
        return ", ".join(words)


PANE = ReviewPane(title="Poles", place=3, make=lambda parts: (StabilisationPicture(parts.state),))
