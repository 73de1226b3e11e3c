"""Tables as wide as there is room for; where words would break, a list of the same rows."""

from __future__ import annotations

import copy

from rich import box
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.table import Column, Table
from rich.text import Text

__all__ = ["FittingTable"]

PROSE = 26  # columns: text beyond is a sentence, which may be folded to this width
HEAD_ROWS = 3  # that a heading may take
_INDENT = 2
_BETWEEN = " · "


class FittingTable:
    """Draw a table whole, else with narrower edges and sentences folded, else as a list.

    Numbers and names are never folded or cut off.

    Parameters
    ----------
    table
        Drawn as it is where its natural width fits.
    """

    def __init__(self, table: Table) -> None:
        self.table = table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Choose by the room there is."""
        yield self._fitted(console, options)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        """Return the measure of what is drawn."""
        return Measurement.get(console, options, self._fitted(console, options))

    def _fitted(self, console: Console, options: ConsoleOptions) -> RenderableType:
        if _natural(self.table, console, options) <= options.max_width:
            return self.table
        narrow = _narrow(self.table)
        if _natural(narrow, console, options) <= options.max_width:
            return narrow
        folded = _folded(narrow, console, options)
        return _as_list(self.table, options.max_width) if folded is None else folded


def _natural(table: Table, console: Console, options: ConsoleOptions) -> int:
    return Measurement.get(console, options.update_width(10_000), table).maximum


def _narrow(table: Table) -> Table:
    narrow = copy.copy(table)
    narrow.columns = [copy.copy(column) for column in table.columns]
    narrow.box, narrow.pad_edge, narrow.expand = box.SIMPLE_HEAD, False, False
    narrow.padding = (0, 0)
    narrow.show_lines = False
    return narrow


def _folded(table: Table, console: Console, options: ConsoleOptions) -> Table | None:
    """Fold headings at their spaces and sentences to what is left; None where that is too little.

    A narrow table has one column more between every two columns, and one at either end.
    """
    unlimited = options.update_width(10_000)
    between = len(table.columns) + 1
    room = options.max_width - between
    sentences = []
    for column in table.columns:
        cells = max((_width(cell, console, unlimited) for cell in column.cells), default=0)
        if cells > PROSE and any(" " in str(cell).strip() for cell in column.cells):
            sentences.append((column, cells))
            continue
        heading = _heading_width(str(column.header))
        column.width, column.no_wrap = max(cells, heading, 1), False
        room -= column.width
    for number, (column, cells) in enumerate(sentences):
        column.width, column.no_wrap = min(room // (len(sentences) - number), cells), False
        if column.width < PROSE:
            return None
        room -= column.width
    return None if room < 0 else table


def _heading_width(heading: str) -> int:
    """Columns in which a heading takes few rows, none of its words broken."""
    words = heading.split()
    longest = max(map(len, words), default=0)
    return max(longest, -(-len(heading) // HEAD_ROWS)) if words else 0


def _width(cell: RenderableType, console: Console, options: ConsoleOptions) -> int:
    return Measurement.get(console, options, cell).maximum


def _as_list(table: Table, width: int) -> RenderableType:
    """Every row as lines: its first cell alone, the others under it behind their headings."""
    parts: list[RenderableType] = []
    if table.title:
        parts.append(Text.assemble(_text(table.title), style="italic"))
    rows = zip(*(list(column.cells) for column in table.columns), strict=True)
    for head, *others in rows:
        told = [
            Text.assemble((_named(column), "dim"), _text(cell))
            for column, cell in zip(table.columns[1:], others, strict=True)
            if str(cell).strip()
        ]
        lines = [Text.assemble(_text(head), style="bold"), *_packed(told, width - _INDENT)]
        parts.append(Text("\n" + " " * _INDENT).join(lines))
    if table.caption:
        parts.append(_text(table.caption))
    return Group(*parts)


def _packed(told: list[Text], width: int) -> list[Text]:
    """Short ones share a line; none is broken that fits one."""
    lines: list[Text] = []
    for one in told:
        if lines and lines[-1].cell_len + len(_BETWEEN) + one.cell_len <= width:
            lines[-1] = Text.assemble(lines[-1], (_BETWEEN, "dim"), one)
        else:
            lines.append(one)
    return lines


def _named(column: Column) -> str:
    heading = " ".join(str(column.header).split())
    return f"{heading} " if heading else ""


def _text(cell: object) -> Text:
    """A cell on one line."""
    text = cell.copy() if isinstance(cell, Text) else Text(str(cell))
    return Text(", ").join(text.split("\n")) if "\n" in text.plain else text
