"""FRFs over one another, their phase and coherence, and what the modes make of them."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from textual.binding import Binding, BindingType

from armodal.analyzer.modal import synthesise
from armodal.protocols.frf_records import Dof, FrfForm
from armodal.tui.drawing import Canvas, Scale, Series, log_scale, plot, plot_frame
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.spectrum import SpectrumPicture
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PANE", "UNITS", "FrfPicture"]

UNITS = {
    FrfForm.RECEPTANCE: "m/N",
    FrfForm.MOBILITY: "m/(s N)",
    FrfForm.ACCELERANCE: "m/(s² N)",
}
_ROWS_FOR_PHASE = 26
TICKS = 6


class FrfPicture(SpectrumPicture):
    """One FRF among all of a posture, or all alike."""

    HELP = """# FRFs
Magnitude over frequency of every FRF, the chosen one bold, the fitted modes' curve beside it;
below, phase and coherence. The arrows left and right move the cursor, up and down choose the FRF.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "choose(-1)", "previous FRF", show=False),
        Binding("down", "choose(1)", "FRF", key_display="↑↓"),
        Binding("a", "overlay", "all"),
        Binding("p", "phase", "phase"),
        Binding("y", "fit", "curve"),
    ]

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(state, id=id)
        self.chosen = 0
        self.overlay = True
        self.phase: bool | None = None  # None: where there is room
        self.fit = True

    def action_choose(self, step: int) -> None:
        """Choose another FRF."""
        frf = self.state.view.frf
        self.chosen = (self.chosen + step) % (len(frf.responses) * len(frf.references))
        self.redraw()

    def action_overlay(self) -> None:
        """Show all FRFs behind the chosen one, or it alone."""
        self.overlay = not self.overlay
        self.redraw()

    def action_phase(self) -> None:
        """Show the phase, or not."""
        self.phase = not self._phase_shown(self.size.height)
        self.redraw()

    def action_fit(self) -> None:
        """Show the fitted modes' curve, or not."""
        self.fit = not self.fit
        self.redraw()

    def _phase_shown(self, rows: int) -> bool:
        return rows >= _ROWS_FOR_PHASE if self.phase is None else self.phase

    def paint(self, columns: int, rows: int) -> Canvas:
        """Magnitude, phase, coherence, one below the other."""
        frf = self.state.view.frf
        i, j = divmod(self.chosen % (len(frf.responses) * len(frf.references)), len(frf.references))
        small = max(rows // 5, 3)
        heights = [rows - 1 - small * (2 if self._phase_shown(rows) else 1)]
        canvas = Canvas(columns, rows)
        canvas.label(0, 0, self._caption(i, j), "bold")
        magnitude = self._magnitude(columns, heights[0], i, j)
        canvas.paste(magnitude, 0, 1)
        at = 1 + heights[0]
        if self._phase_shown(rows):
            canvas.paste(self._phase(columns, small, i, j), 0, at)
            at += small
        canvas.paste(self._coherence(columns, small, i, j), 0, at)
        return canvas

    def _caption(self, i: int, j: int) -> str:
        frf, line = self.state.view.frf, self.cursor_line()
        value, coherence = frf.values[i, j, line], frf.coherence[i, j, line]
        told = "no coherence available" if np.isnan(coherence) else f"coherence {coherence:.3f}"
        return (
            f"{_dof(frf.responses[i])} ← {_dof(frf.references[j])}   {frf.freq_hz[line]:.2f} Hz: "
            f"{abs(value):.3g} {UNITS[frf.form]}, {np.degrees(np.angle(value)):+.0f}°, {told}"
        )

    def _magnitude(self, columns: int, rows: int, i: int, j: int) -> Canvas:
        frf, x = self.state.view.frf, self.x_scale()
        size = np.abs(frf.values)
        shown = x.holds(frf.freq_hz)
        behind = []
        if self.overlay:
            behind = [
                Series(x=frf.freq_hz, y=size[a, b], style=self.inks.weak)
                for a in range(size.shape[0])
                for b in range(size.shape[1])
            ]
        series = behind
        model = self.state.model
        if self.fit and model is not None and model.modes:
            low, high = model.band_hz
            lines = frf.freq_hz[(frf.freq_hz >= low) & (frf.freq_hz <= high)]
            curve = np.abs(synthesise(model, lines, decay_rad_s=frf.decay_rad_s)[i, j])
            series.append(Series(x=lines, y=curve, style=self.inks.fit))
        # Last, so that the modes' curve is seen where it departs from what was measured.
        series.append(Series(x=frf.freq_hz, y=size[i, j], style=self.inks.strong))
        y = log_scale(size[..., shown] if self.overlay else size[i, j][shown], most_decades=5.0)
        self.frame = plot_frame(columns, rows, x, y, title="t", left=TICKS)
        return plot(
            columns,
            rows,
            series,
            x=x,
            y=y,
            title=f"{frf.form.value} {UNITS[frf.form]}: {self._names()}",
            x_name="Hz",
            cursors=self.mode_cursors(),
            left=TICKS,
        )

    def _names(self) -> str:
        parts = ["chosen FRF bold"]
        if self.overlay:
            parts.append("all others dim")
        if self.fit and self.state.model is not None:
            parts.append("modes' curve where it differs")
        return ", ".join(parts)

    def _phase(self, columns: int, rows: int, i: int, j: int) -> Canvas:
        frf = self.state.view.frf
        phase = np.degrees(np.angle(frf.values[i, j]))
        phase[:-1][np.abs(np.diff(phase)) > 180.0] = np.nan  # no line across the wrap
        return plot(
            columns,
            rows,
            [Series(x=frf.freq_hz, y=phase, style=self.inks.strong)],
            x=self.x_scale(),
            y=Scale(low=-180.0, high=180.0, step=180.0),
            title="phase °",
            x_axis=False,
            left=TICKS,
        )

    def _coherence(self, columns: int, rows: int, i: int, j: int) -> Canvas:
        frf = self.state.view.frf
        known = bool(np.isfinite(frf.coherence[i, j]).any())
        return plot(
            columns,
            rows,
            [Series(x=frf.freq_hz, y=frf.coherence[i, j], style=self.inks.strong)],
            x=self.x_scale(),
            y=Scale(low=0.0, high=1.0, step=0.5),
            title="coherence" if known else "no coherence available for these FRFs",
            x_axis=False,
            left=TICKS,
        )


def _dof(dof: Dof) -> str:
    return f"{dof.label} {dof.point}" if dof.label == "hit" else f"point {dof.point} {dof.label}"


PANE = ReviewPane(title="FRF", place=1, make=lambda parts: (FrfPicture(parts.state),))
