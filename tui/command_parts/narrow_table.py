"""Tables for a terminal of 80 columns."""

from __future__ import annotations

from rich import box
from rich.table import Table

__all__ = ["narrow_table"]


def narrow_table(title: str, columns: tuple[str, ...]) -> Table:
    """A table that keeps to 80 columns: the first one left, no lines between, no cell folded."""
    table = Table(title=title, box=box.SIMPLE_HEAD, pad_edge=False, padding=0)
    for i, column in enumerate(columns):
        table.add_column(column, justify="left" if i == 0 else "right", no_wrap=True)
    return table
