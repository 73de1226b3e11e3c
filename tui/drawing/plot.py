"""Plots with axes on a braille canvas: lines, min/max envelopes, scatter, cursors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.tui.drawing.canvas import CELL_HEIGHT, CELL_WIDTH, Canvas
from armodal.tui.drawing.scale import Scale, tick_text

__all__ = ["Cursor", "Frame", "Series", "envelope", "plot", "plot_frame"]

Array = npt.NDArray[np.float64]

_AXIS = "dim"
_NAME_ROWS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """One line or cloud of points.

    With a `glyph` every point is that character; without, the points are joined. A line with
    more points than pixel columns is drawn as its minimum and maximum in every column, so that
    nothing hides between pixels.
    """

    x: npt.ArrayLike  # (n,); increasing for a line with many points
    y: npt.ArrayLike  # (n,); NaN breaks the line
    style: str = ""
    glyph: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cursor:
    """A vertical line at `x`, named at its top."""

    x: float
    name: str = ""
    style: str = "dim"


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """Where a plot's field lies on its canvas, in cells, and the scales of its axes."""

    left: int
    top: int
    columns: int
    rows: int
    x: Scale
    y: Scale

    def pixels(self, x: npt.ArrayLike, y: npt.ArrayLike) -> Array:
        """Pixels (n, 2) of data points; NaN where a value has no place on its scale."""
        width, height = self.columns * CELL_WIDTH, self.rows * CELL_HEIGHT
        across = self.left * CELL_WIDTH + self.x.share(x) * (width - 1)
        down = self.top * CELL_HEIGHT + (1.0 - self.y.share(y)) * (height - 1)
        return np.stack(np.broadcast_arrays(across, down), axis=-1)

    def value_at(self, column: int, row: int) -> tuple[float, float] | None:
        """Data (x, y) at the middle of a cell of the canvas; None outside the field."""
        across, down = column - self.left, row - self.top
        if not (0 <= across < self.columns and 0 <= down < self.rows):
            return None
        return (
            self.x.value((across + 0.5) / self.columns),
            self.y.value(1.0 - (down + 0.5) / self.rows),
        )


def envelope(x: Array, y: Array, edges: Array) -> tuple[Array, Array, Array]:
    """Least and largest y between neighbouring `edges`: middles, minima, maxima.

    Bins without a sample are left out; a NaN among the samples of a bin is passed over.

    Parameters
    ----------
    x, y
        (n,) samples, x increasing.
    edges
        (m,) increasing.
    """
    known = np.isfinite(y)
    x, y = x[known], y[known]
    first = np.searchsorted(x, edges)
    full = np.flatnonzero(np.diff(first) > 0)
    if not full.size:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    y = y[: first[-1]]
    begin = first[full]
    middle = (edges[full] + edges[full + 1]) / 2
    return middle, np.minimum.reduceat(y, begin), np.maximum.reduceat(y, begin)


def plot_frame(
    columns: int,
    rows: int,
    x: Scale,
    y: Scale,
    *,
    title: str = "",
    x_axis: bool = True,
    left: int | None = None,
) -> Frame:
    """Return where the field of a plot of that size lies: below the title, right of the ticks."""
    top = 1 if title else 0
    below = 1 if x_axis else 0
    inner = max(rows - top - below, 1)
    width = max((len(tick_text(t)) for t in y.ticks(max(inner // 3, 2))), default=1)
    left = min(width + 1 if left is None else left, columns // 3)
    return Frame(left=left, top=top, columns=max(columns - left, 1), rows=inner, x=x, y=y)


def plot(
    columns: int,
    rows: int,
    series: Sequence[Series],
    *,
    x: Scale,
    y: Scale,
    title: str = "",
    x_axis: bool = True,
    x_name: str = "",
    cursors: Sequence[Cursor] = (),
    left: int | None = None,
) -> Canvas:
    """Draw series in one frame.

    Parameters
    ----------
    columns, rows
        Size of the whole plot in cells.
    series
        Drawn in turn; the last lies on top.
    x, y
        Scales of the axes.
    title
        Written in the first row, when given.
    x_axis
        Whether the last row holds the ticks of x.
    x_name
        Unit of x, written at the right end of its ticks.
    cursors
        Vertical lines.
    left
        Cells left of the field, so that plots one below the other agree; what the ticks need
        when omitted.
    """
    canvas = Canvas(columns, rows)
    frame = plot_frame(canvas.columns, canvas.rows, x, y, title=title, x_axis=x_axis, left=left)
    canvas.label(frame.left, 0, title, "bold")
    _axes(canvas, frame, x_name if x_axis else None)
    for cursor in cursors:
        _cursor(canvas, frame, cursor)
    for one in series:
        _series(canvas, frame, one)
    _cursor_names(canvas, frame, cursors)
    return canvas


def _axes(canvas: Canvas, frame: Frame, x_name: str | None) -> None:
    bottom = frame.top + frame.rows
    for row in range(frame.top, bottom):
        canvas.label(frame.left - 1, row, "│", _AXIS)
    last = bottom
    for tick in reversed(frame.y.ticks(max(frame.rows // 3, 2))):
        row = frame.top + round((1.0 - float(frame.y.share(tick))) * (frame.rows - 1))
        text = tick_text(tick)
        if frame.top <= row < last or last == bottom:
            canvas.label(frame.left - 1 - len(text), row, text, _AXIS)
            canvas.label(frame.left - 1, row, "┤", _AXIS)
    if x_name is None:
        return
    free = frame.left
    end = frame.left + frame.columns - (len(x_name) + 1 if x_name else 0)
    for tick in frame.x.ticks(max(frame.columns // 10, 2)):
        text = tick_text(tick)
        middle = frame.left + float(frame.x.share(tick)) * (frame.columns - 1)
        at = max(round(middle - (len(text) - 1) / 2), frame.left)
        if at >= free and at + len(text) <= end:
            canvas.label(at, bottom, text, _AXIS)
            free = at + len(text) + 1
    canvas.label(frame.left + frame.columns - len(x_name), bottom, x_name, _AXIS)


def _cursor_names(canvas: Canvas, frame: Frame, cursors: Sequence[Cursor]) -> None:
    """Write names beside their lines, one row lower where another name is in the way."""
    taken = [0] * _NAME_ROWS
    for cursor in sorted(cursors, key=lambda one: one.x):
        share = float(frame.x.share(cursor.x))
        if not cursor.name or not 0.0 <= share <= 1.0:
            continue
        at = frame.left + int(share * (frame.columns - 1)) + 1
        at = min(at, frame.left + frame.columns - len(cursor.name))
        row = next((r for r in range(min(_NAME_ROWS, frame.rows)) if taken[r] <= at), 0)
        taken[row] = at + len(cursor.name) + 1
        canvas.label(at, frame.top + row, cursor.name, cursor.style)


def _cursor(canvas: Canvas, frame: Frame, cursor: Cursor) -> None:
    share = float(frame.x.share(cursor.x))
    if not 0.0 <= share <= 1.0:
        return
    across = frame.left * CELL_WIDTH + share * (frame.columns * CELL_WIDTH - 1)
    down = np.arange(frame.top * CELL_HEIGHT, (frame.top + frame.rows) * CELL_HEIGHT, 2)
    canvas.dots(np.stack([np.full(down.size, across), down], axis=1), cursor.style)


def _series(canvas: Canvas, frame: Frame, one: Series) -> None:
    x = np.asarray(one.x, dtype=np.float64).reshape(-1)
    y = np.asarray(one.y, dtype=np.float64).reshape(-1)
    n_pixels = frame.columns * CELL_WIDTH
    if one.glyph:
        at = frame.pixels(x, y)
        inside = frame.x.holds(x) & frame.y.holds(y)
        canvas.mark(at[inside], one.glyph, one.style)
        return
    shown = frame.x.holds(x)
    # One sample beyond each end, so that the line reaches the frame.
    shown = shown | np.append(shown[1:], False) | np.append(False, shown[:-1])
    x, y = x[shown], np.where(frame.y.places(y[shown]), y[shown], np.nan)
    if x.size > 2 * n_pixels:
        edges = np.array([frame.x.value(s) for s in np.linspace(0.0, 1.0, n_pixels + 1)])
        middle, low, high = envelope(x, y, edges)
        # Columns meet: each reaches at least to the nearer end of the one before.
        low[1:], high[1:] = (
            np.minimum(low[1:], high[:-1]),
            np.maximum(high[1:], low[:-1]),
        )
        begin, end = frame.pixels(middle, low), frame.pixels(middle, high)
    else:
        at = frame.pixels(x, y)
        begin, end = at[:-1], at[1:]
        canvas.dots(_within(frame, at), one.style)
    _clipped_segments(canvas, frame, begin, end, one.style)


def _within(frame: Frame, at: Array) -> Array:
    low = np.array([frame.left * CELL_WIDTH, frame.top * CELL_HEIGHT]) - 0.5
    high = low + np.array([frame.columns * CELL_WIDTH, frame.rows * CELL_HEIGHT])
    with np.errstate(invalid="ignore"):
        kept: Array = at[((at >= low) & (at < high)).all(axis=1)]
    return kept


def _clipped_segments(canvas: Canvas, frame: Frame, begin: Array, end: Array, style: str) -> None:
    """Draw on a canvas of the field's size, so that nothing runs over the axes."""
    field_only = Canvas(frame.columns, frame.rows)
    corner = np.array([frame.left * CELL_WIDTH, frame.top * CELL_HEIGHT])
    field_only.segments(begin - corner, end - corner, style)
    canvas.overlay(field_only, frame.left, frame.top)
