"""Tables of numbers in text, as analysers and loggers write them.

A file is read in sections: a header, then rows of numbers; lines of words behind the numbers open
the next section. Numbers are read by numpy line by line, so that a file of 100 MB takes little
more than its bytes and its numbers.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from functools import partial
from typing import Any, TextIO

import numpy as np
import numpy.typing as npt

from armodal.protocols.bounds import MOST_TEXT_NUMBERS
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.even import is_counter, is_even
from armodal.protocols.foreign.text_dialect import (
    HEAD_BYTES,
    Dialect,
    cells,
    dialect_of,
    encoding_of,
    is_row,
)
from armodal.protocols.foreign.text_header import Header, read_header
from armodal.protocols.foreign.units import hertz, seconds
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["numbers_of_rows", "text_variables"]

_MOST_SECTIONS = 1000
_MOST_COLUMNS = 4096
_LONGEST_LINE = 2**20
_MOST_LISTED_WORDS = 60
_OF_NUMBERS = frozenset("+-.0123456789")  # what begins with one is no word


class _Rows:
    """Lines of a text, with one that was read too far given back."""

    def __init__(self, stream: TextIO, origin: str) -> None:
        self._stream = stream
        self._origin = origin
        self._kept: list[str] = []
        self.numbers_left = MOST_TEXT_NUMBERS

    def __iter__(self) -> Iterator[str]:
        """Yield the lines that are left."""
        while self._kept:
            yield self._kept.pop()
        for line in iter(partial(self._stream.readline, _LONGEST_LINE), ""):
            if len(line) >= _LONGEST_LINE:
                raise ForeignFileError(
                    f"{self._origin}: wanted lines of text, got one of a million characters: the "
                    "file is no table; export it as text"
                )
            yield line

    def take(self) -> str:
        """Return the next line, empty at the end."""
        return next(iter(self), "")

    def give_back(self, lines: list[str]) -> None:
        """Put lines before what is left."""
        self._kept.extend(reversed(lines))


def text_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the sections of a text.

    Raises
    ------
    ForeignFileError
        If it is no text, or has no rows of numbers, or a row is not like the others.
    """
    encoding = encoding_of(data, origin)
    try:
        return tuple(_sections(data, encoding, origin))
    except UnicodeDecodeError:  # one strange byte far behind the head
        return tuple(_sections(data, "latin-1", origin))


def _sections(data: bytes, encoding: str, origin: str) -> Iterator[Variables]:
    rows = _Rows(io.TextIOWrapper(io.BytesIO(data), encoding=encoding), origin)
    count = 0
    while True:
        head = _head(rows)
        found = dialect_of(head)
        if found is None:
            if count == 0:
                raise _no_table(head, origin)
            return
        dialect, at = found
        rows.give_back(head[at:])
        count += 1
        if count > _MOST_SECTIONS:
            raise ForeignFileError(
                f"{origin}: wanted at most {_MOST_SECTIONS} tables, got more; split the file"
            )
        where = origin if count == 1 else f"{origin}: {count}"
        yield _section(rows, head[:at], dialect, where)


def _head(rows: _Rows) -> list[str]:
    """Return lines to look for the beginning of numbers in."""
    lines: list[str] = []
    size = 0
    while size < HEAD_BYTES and len(lines) < 4000 and (line := rows.take()):
        lines.append(line)
        size += len(line)
    return lines


def _section(rows: _Rows, head: list[str], dialect: Dialect, origin: str) -> Variables:
    first = rows.take()
    rows.give_back([first])
    row = cells(first, dialect)
    columns = [i for i, cell in enumerate(row) if cell]
    if len(columns) > _MOST_COLUMNS:
        raise ForeignFileError(
            f"{origin}: wanted at most {_MOST_COLUMNS} columns, got {len(columns)}; export fewer"
        )
    for i, line in enumerate(head):
        if (
            is_row(line, dialect)
            and [j for j, c in enumerate(cells(line, dialect)) if c] == columns
        ):
            raise ForeignFileError(
                f"{origin}: wanted rows alike, line {i + 1} is followed by one that is not: "
                f"{head[i + 1][:40].strip()!r}; truncated or damaged?"
            )
    header = read_header(head, columns, dialect)
    lines = _until_words(rows, rows.numbers_left // len(columns), origin)
    table = numbers_of_rows(lines, first, columns, dialect, origin)
    rows.numbers_left -= table.size
    return _variables(table, header, origin)


def _until_words(rows: _Rows, most: int, origin: str) -> Iterator[str]:
    """Yield lines until one of words; blank ones are passed over."""
    found = 0
    for line in rows:
        if line[0] not in _OF_NUMBERS:
            text = line.lstrip("\"' \t")
            if text[:3].isalpha() and text[:3].lower() not in {"nan", "inf"}:
                rows.give_back([line])
                return
            if not text.strip():
                continue
        if found >= most:
            raise ForeignFileError(
                f"{origin}: wanted at most {MOST_TEXT_NUMBERS:,} numbers in a text, got more; "
                "split the file, or export MAT, WAV or HDF5"
            )
        found += 1
        yield line


def numbers_of_rows(
    lines: Iterator[str], first: str, columns: list[int], dialect: Dialect, origin: str
) -> npt.NDArray[np.float64] | npt.NDArray[np.complex128]:
    """Return the numbers in rows of text, (rows, columns).

    Raises
    ------
    ForeignFileError
        If a row has other columns, or a cell is no number.
    """
    changes = [(",", ".")] if dialect.decimal == "," else []
    if any("d" in cell.lower() for cell in cells(first, dialect)):
        changes += [("D", "E"), ("d", "e")]
    delimiter = dialect.delimiter
    if dialect.is_complex:
        if "i" in first.lower():
            changes += [("i", "j")]
        if delimiter is not None or len(columns) == 1:
            changes += [(" ", "")]
    clean = lines if not changes else (_changed(line, changes) for line in lines)
    n_cells = len(cells(first, dialect))
    try:
        table: npt.NDArray[Any] = np.loadtxt(
            clean,
            dtype=np.complex128 if dialect.is_complex else np.float64,
            delimiter=delimiter,
            comments=None,
            quotechar='"' if '"' in first else None,
            usecols=None if n_cells == len(columns) else columns,
            ndmin=2,
        )
    except ForeignFileError:  # said of the lines
        raise
    except (ValueError, IndexError) as error:
        said = _first_line(error).partition(";")[0]  # behind it, advice for those who program
        raise ForeignFileError(
            f"{origin}: wanted a table of numbers ({said}); truncated or damaged?"
        ) from error
    return table


def _changed(line: str, changes: list[tuple[str, str]]) -> str:
    for old, new in changes:
        line = line.replace(old, new)
    return line


def _variables(
    table: npt.NDArray[np.float64] | npt.NDArray[np.complex128], header: Header, origin: str
) -> Variables:
    columns = _columns(table)
    n = len(columns)
    units = list(header.units) if header.units else [""] * n
    names = list(header.names) or [""] * n
    if n > 2 and not names[0] and is_counter(columns[0]) and is_even(columns[1]):
        columns, units, names = columns[1:], units[1:], names[1:]
    named = any(names) or any(units)
    names = [name or f"column {n - len(names) + i + 1}" for i, name in enumerate(names)]
    repeated = {name for name in names if names.count(name) > 1}
    seen: dict[str, int] = {}
    for i, name in enumerate(names):
        if name in repeated:
            seen[name] = seen.get(name, 0) + 1
            names[i] = f"{name} {seen[name]}"
    units[0] = units[0] or header.x_unit
    if header.y_unit:
        units[1:] = [unit or header.y_unit for unit in units[1:]]
    if named and not header.names:
        names[0] = _axis_name(units[0]) or names[0]
    axis = None
    if header.rate_hz is not None:
        axis = Axis(unit="s", first=0.0, step=1.0 / header.rate_hz)
    return Variables(
        origin=origin,
        format="text table",
        variables=tuple(
            Variable(name=name, values=column, unit=unit)
            for name, column, unit in zip(names, columns, units, strict=True)
        ),
        named=named,
        is_table=True,
        axis=axis,
        texts=header.texts,
        words=header.words,
    )


def _columns(
    table: npt.NDArray[np.float64] | npt.NDArray[np.complex128],
) -> list[npt.NDArray[np.float64] | npt.NDArray[np.complex128]]:
    """Return the columns; those of a complex table that are real throughout as real."""
    columns = []
    for column in table.T:
        is_real = np.iscomplexobj(column) and table.shape[1] > 1 and not np.any(column.imag)
        columns.append(np.real(column) if is_real else column)
    return columns


def _axis_name(unit: str) -> str:
    if hertz(unit):
        return "frequency"
    return "time" if seconds(unit) else ""


def _no_table(head: list[str], origin: str) -> ForeignFileError:
    filled = [line.strip() for line in head if line.strip()]
    first = repr(filled[0][:_MOST_LISTED_WORDS]) if filled else "nothing"
    return ForeignFileError(
        f"{origin}: wanted a table of numbers, got {len(filled)} lines without one, the first is "
        f"{first}; export rows of numbers"
    )


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:160]
