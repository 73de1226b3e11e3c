"""The complex mode indicator function, and sums of FRFs over groups of points."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from textual.binding import Binding, BindingType

from armodal.analyzer.modal import cmif, group_sums
from armodal.protocols.errors import EstimateError
from armodal.tui.drawing import Canvas, Series, log_scale, plot, plot_frame
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.panes.frf import UNITS
from armodal.tui.screens.review.spectrum import SpectrumPicture
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PANE", "CmifPicture"]

_GROUP_GLYPHS = "abcdefgh"
_GLYPH_EVERY = 8  # cells between the letters that tell groups apart


class CmifPicture(SpectrumPicture):
    """Singular values over frequency; a peak is a mode."""

    HELP = """# CMIF
Singular values of the FRF matrix over frequency: a peak of the first is a mode, a peak of the
second at the same frequency is another mode close to it. `g` shows the sums over the arm's groups
of points, each marked with its letter.
"""
    BINDINGS: ClassVar[list[BindingType]] = [Binding("g", "groups", "groups")]

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(state, id=id)
        self.groups = False

    def action_groups(self) -> None:
        """Show sums over groups of points, or singular values."""
        self.groups = not self.groups
        self.redraw()

    def paint(self, columns: int, rows: int) -> Canvas:
        """Draw one plot below its caption."""
        frf, x = self.state.view.frf, self.x_scale()
        caption = f"{frf.freq_hz[self.cursor_line()]:.2f} Hz"
        if self.groups:
            series, names = self._group_series(columns)
        else:
            values = cmif(frf)
            series = [
                Series(
                    x=frf.freq_hz,
                    y=values[:, number],
                    style=self.inks.strong if number == 0 else self.inks.weak,
                )
                for number in reversed(range(values.shape[1]))
            ]
            caption += f": {values[self.cursor_line(), 0]:.3g} {UNITS[frf.form]}"
            names = f"CMIF, {values.shape[1]} singular value{'s' * (values.shape[1] > 1)}"
        shown = x.holds(frf.freq_hz)
        lines = [np.asarray(one.y)[shown] for one in series if not one.glyph]
        y = log_scale(*lines, most_decades=5.0)
        canvas = Canvas(columns, rows)
        canvas.label(0, 0, caption, "bold")
        self.frame = plot_frame(columns, rows - 1, x, y, title="t")
        picture = plot(
            columns,
            rows - 1,
            series,
            x=x,
            y=y,
            title=f"{names}; {UNITS[frf.form]}",
            x_name="Hz",
            cursors=self.mode_cursors(),
        )
        canvas.paste(picture, 0, 1)
        return canvas

    def _group_series(self, columns: int) -> tuple[list[Series], str]:
        frf = self.state.view.frf
        try:
            sums = group_sums(frf, self.state.opened.session.header.arm.groups)
        except EstimateError as error:
            return [], str(error)
        if not sums:
            return [], "the arm file names no groups of points"
        series, names = [], []
        inks = (self.inks.strong, self.inks.fit, self.inks.plain, self.inks.weak)
        x = self.x_scale()
        marks = np.linspace(x.low, x.high, max(columns // _GLYPH_EVERY, 3))[1:-1]
        for number, (name, values) in enumerate(sums.items()):
            glyph, style = _GROUP_GLYPHS[number % len(_GROUP_GLYPHS)], inks[number % len(inks)]
            series.append(Series(x=frf.freq_hz, y=values, style=style))
            at = marks + (x.high - x.low) * number / (len(sums) * (marks.size + 1))
            series.append(
                Series(x=at, y=np.interp(at, frf.freq_hz, values), glyph=glyph, style=style)
            )
            names.append(f"{glyph} {name}")
        return series, "sums of " + ", ".join(names)


PANE = ReviewPane(title="CMIF", place=2, make=lambda parts: (CmifPicture(parts.state),))
