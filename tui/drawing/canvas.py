"""A canvas of braille pixels: two across and four down in every character cell.

A terminal cell is about twice as high as wide, so the pixels are square. Each ink is a layer;
where layers meet in a cell the dots of all are shown in the style of the one drawn last. Labels
lie above all dots.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual.strip import Strip

__all__ = ["CELL_HEIGHT", "CELL_WIDTH", "Canvas"]

CELL_WIDTH, CELL_HEIGHT = 2, 4  # pixels a cell
_BRAILLE = 0x2800
# Bit of each dot in a cell, by row and column (Unicode 6.0, block 2800).
_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.uint16)

Array = npt.NDArray[np.float64]


class Canvas:
    """Pixels, layers and labels on a grid of character cells.

    Pixel coordinates are (x to the right, y downwards) from the top left corner; whatever lies
    outside is clipped, and what is not finite is left out.

    Parameters
    ----------
    columns, rows
        Size in cells; at least one of each is kept.
    """

    def __init__(self, columns: int, rows: int) -> None:
        self.columns, self.rows = max(columns, 1), max(rows, 1)
        self.width, self.height = self.columns * CELL_WIDTH, self.rows * CELL_HEIGHT
        self._bits = np.zeros((self.rows, self.columns), dtype=np.uint16)
        self._ink = np.zeros((self.rows, self.columns), dtype=np.int32)
        self._label = np.zeros((self.rows, self.columns), dtype=np.int32)
        self._styles: list[str] = [""]

    def _ink_number(self, style: str) -> int:
        if style not in self._styles:
            self._styles.append(style)
        return self._styles.index(style)

    def dots(self, xy: npt.ArrayLike, style: str = "") -> None:
        """Set the pixels nearest to `xy` (n, 2)."""
        points = np.asarray(xy, dtype=np.float64).reshape(-1, 2)
        inside = np.isfinite(points).all(axis=1)
        inside &= (points >= -0.5).all(axis=1)
        inside &= (points[:, 0] < self.width - 0.5) & (points[:, 1] < self.height - 0.5)
        at = np.floor(points[inside] + 0.5).astype(np.intp)
        column, row = at[:, 0] // CELL_WIDTH, at[:, 1] // CELL_HEIGHT
        bits = _BITS[at[:, 1] % CELL_HEIGHT, at[:, 0] % CELL_WIDTH]
        np.bitwise_or.at(self._bits, (row, column), bits)
        self._ink[row, column] = self._ink_number(style)

    def segments(self, begin: npt.ArrayLike, end: npt.ArrayLike, style: str = "") -> None:
        """Draw straight lines from each of `begin` (n, 2) to each of `end` (n, 2)."""
        first, last = _clipped(
            np.asarray(begin, dtype=np.float64).reshape(-1, 2),
            np.asarray(end, dtype=np.float64).reshape(-1, 2),
            (self.width - 1.0, self.height - 1.0),
        )
        if not len(first):
            return
        steps = np.ceil(np.abs(last - first).max(axis=1)).astype(np.intp) + 1
        which = np.repeat(np.arange(len(steps)), steps)
        number = np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)
        share = number / np.maximum(steps - 1, 1)[which]
        self.dots(first[which] + share[:, None] * (last - first)[which], style)

    def polyline(self, xy: npt.ArrayLike, style: str = "") -> None:
        """Join the pixels `xy` (n, 2) in turn; a point that is not finite breaks the line."""
        points = np.asarray(xy, dtype=np.float64).reshape(-1, 2)
        if len(points) == 1:
            self.dots(points, style)
        self.segments(points[:-1], points[1:], style)

    def label(self, column: int, row: int, text: str, style: str = "") -> None:
        """Write `text` above the dots, from cell (column, row) to the right, clipped."""
        if not 0 <= row < self.rows:
            return
        ink = self._ink_number(style)
        for offset, character in enumerate(text):
            at = column + offset
            if 0 <= at < self.columns and cell_len(character) == 1:
                self._label[row, at] = ord(character)
                self._ink[row, at] = ink

    def mark(self, xy: npt.ArrayLike, text: str, style: str = "", *, beside: int = 0) -> None:
        """Write `text` with its first letter in the cell of each pixel of `xy` (n, 2).

        `beside` moves it that many cells to the right.
        """
        for x, y in np.asarray(xy, dtype=np.float64).reshape(-1, 2):
            if np.isfinite(x) and np.isfinite(y):
                column = int(np.floor((x + 0.5) / CELL_WIDTH))
                self.label(column + beside, int(np.floor((y + 0.5) / CELL_HEIGHT)), text, style)

    def overlay(self, other: Canvas, column: int, row: int) -> None:
        """Lay another canvas's dots over this one, its corner at cell (column, row)."""
        rows, columns = (
            min(other.rows, self.rows - row),
            min(other.columns, self.columns - column),
        )
        inks = np.array([self._ink_number(style) for style in other._styles], dtype=np.int32)
        bits = other._bits[:rows, :columns]
        here = slice(row, row + rows), slice(column, column + columns)
        self._bits[here] |= bits
        free = (bits > 0) & (self._label[here] == 0)
        self._ink[here] = np.where(free, inks[other._ink[:rows, :columns]], self._ink[here])

    def plain(self) -> list[str]:
        """Return the rows as text without style."""
        return ["".join(map(chr, row)) for row in self._codes()]

    def strips(self) -> list[Strip]:
        """Return the rows as Textual strips, one segment a run of equal style."""
        return [
            Strip([Segment(text, style) for text, style in row], self.columns)
            for row in self._runs()
        ]

    def text(self) -> Text:
        """Return the whole canvas as one Rich text."""
        rows = self._runs()
        text = Text(no_wrap=True, end="")
        for number, row in enumerate(rows):
            for run, style in row:
                text.append(run, style)
            if number + 1 < len(rows):
                text.append("\n")
        return text

    def _codes(self) -> npt.NDArray[np.int32]:
        dots = np.where(self._bits > 0, _BRAILLE + self._bits.astype(np.int32), ord(" "))
        return np.where(self._label > 0, self._label, dots).astype(np.int32)

    def _runs(self) -> list[list[tuple[str, Style]]]:
        styles = [Style.parse(style) for style in self._styles]
        runs = []
        for codes, inks in zip(self._codes(), self._ink, strict=True):
            characters = "".join(map(chr, codes))
            edges = [0, *(np.flatnonzero(np.diff(inks)) + 1).tolist(), self.columns]
            runs.append([(characters[a:b], styles[inks[a]]) for a, b in pairwise(edges)])
        return runs


def _clipped(begin: Array, end: Array, corner: tuple[float, float]) -> tuple[Array, Array]:
    """Parts of the segments within (0, 0) to `corner`, by Liang and Barsky (1984)."""
    finite = np.isfinite(begin).all(axis=1) & np.isfinite(end).all(axis=1)
    first, last = begin[finite], end[finite]
    step = last - first
    enter, leave = np.zeros(len(first)), np.ones(len(first))
    for axis in (0, 1):
        for direction, room in ((-1.0, first[:, axis]), (1.0, corner[axis] - first[:, axis])):
            p = direction * step[:, axis]
            with np.errstate(divide="ignore", invalid="ignore"):
                share = room / p
            enter = np.where(p < 0.0, np.maximum(enter, share), enter)
            leave = np.where(p > 0.0, np.minimum(leave, share), leave)
            leave = np.where((p == 0.0) & (room < 0.0), -1.0, leave)
    kept = enter <= leave
    first, step, enter, leave = first[kept], step[kept], enter[kept], leave[kept]
    return first + enter[:, None] * step, first + leave[:, None] * step
