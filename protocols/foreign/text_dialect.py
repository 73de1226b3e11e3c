"""How a text of numbers is written: encoding, delimiter, decimal sign, and where numbers begin."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass

from armodal.protocols.errors import ForeignFileError

__all__ = ["Dialect", "cells", "dialect_of", "encoding_of", "is_number", "is_row"]

HEAD_BYTES = 2**20  # where a header and the first numbers are looked for
_MOST_HEADER_LINES = 2000
_LONGEST_NUMBER = 100  # characters, of a complex one
_ROWS_TOLD = 4  # rows alike that make the numbers begin
_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_CONTROLS = re.compile(r"[\x00-\x08\x0e-\x19\x1b-\x1f\x7f]")
_C1 = re.compile(r"[\x80-\x9f]")
_UNSIGNED = r"(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"
_REAL = rf"(?:[+-]?{_UNSIGNED}|[+-]?(?:nan|inf))"
_NUMBER = re.compile(_REAL, re.IGNORECASE)
_COMPLEX = re.compile(
    rf"\(?\s*{_REAL}\s*[+-]\s*(?:{_UNSIGNED}\s*\*?\s*[ij]|[ij]\s*\*?\s*{_UNSIGNED})\s*\)?",
    re.IGNORECASE,
)
# In this order: a comma is a delimiter only where neither tab nor semicolon is one.
_TRIED = (
    (";", ","), (";", "."), ("\t", "."), ("\t", ","), (",", "."), (None, "."), (None, ","),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Dialect:
    """How rows are parted into cells; `delimiter` None is any run of blanks."""

    delimiter: str | None
    decimal: str
    is_complex: bool = False


def encoding_of(data: bytes, origin: str) -> str:
    """Return the encoding of a text by its first bytes.

    Raises
    ------
    ForeignFileError
        If there are control characters as no text has them.
    """
    head = data[:HEAD_BYTES]
    for bom, name in _BOMS:
        if head.startswith(bom):
            return name
    if len(head) > 8 and head[1:8:2] == b"\0" * 4 and b"\0" not in head[0:8:2]:
        return "utf-16-le"
    if len(head) > 8 and head[0:8:2] == b"\0" * 4 and b"\0" not in head[1:8:2]:
        return "utf-16-be"
    try:
        text = codecs.getincrementaldecoder("utf-8")().decode(head)
        name = "utf-8"
    except UnicodeDecodeError:
        text, name = head.decode("latin-1"), "latin-1"
        if _C1.search(text) and _decodes(head, "cp932"):  # headers in Japanese
            text, name = head.decode("cp932", "replace"), "cp932"
    if _CONTROLS.search(text):
        raise ForeignFileError(
            f"{origin}: wanted a table of numbers as text, got control characters: the file is "
            "binary or damaged; export it as text, or give it its program's ending"
        )
    return name


def _decodes(head: bytes, name: str) -> bool:
    try:
        codecs.getincrementaldecoder(name)().decode(head)
    except UnicodeDecodeError:
        return False
    return True


def dialect_of(lines: list[str]) -> tuple[Dialect, int] | None:
    """Return how a text is written, and the line at which its numbers begin; None for no table.

    Parameters
    ----------
    lines
        The first lines of the text, without their ends.
    """
    for at in range(min(len(lines), _MOST_HEADER_LINES)):
        if not lines[at].strip():
            continue
        for delimiter, decimal in _TRIED:
            for is_complex in (False, True):
                dialect = Dialect(delimiter=delimiter, decimal=decimal, is_complex=is_complex)
                if _begins(lines, at, dialect):
                    return dialect, at
    return None


def _begins(lines: list[str], at: int, dialect: Dialect) -> bool:
    """Whether rows of numbers, alike in their columns, begin at a line."""
    if not is_row(lines[at], dialect):
        return False
    row = cells(lines[at], dialect)
    filled = [i for i, cell in enumerate(row) if cell]
    for line in [line for line in lines[at + 1 : at + 3 * _ROWS_TOLD] if line.strip()][
        : _ROWS_TOLD - 1
    ]:
        other = cells(line, dialect)
        if not is_row(line, dialect) or [i for i, cell in enumerate(other) if cell] != filled:
            return False
    if len(filled) > 1:
        return True
    return dialect.is_complex or dialect.delimiter is None


def cells(line: str, dialect: Dialect) -> list[str]:
    """Return the cells of a line, blanks and quotes taken off."""
    text = line.strip("\r\n")
    if dialect.delimiter is None and dialect.is_complex:
        # Blanks may stand inside of a complex number: only those before a bracket part cells.
        parts = re.split(r"\s+(?=\()", text.strip()) if "(" in text else [text.strip()]
        return [part.strip() for part in parts]
    parts = text.split(dialect.delimiter) if dialect.delimiter else text.split()
    return [part.strip().strip('"').strip() for part in parts]


def is_row(line: str, dialect: Dialect) -> bool:
    """Return whether every filled cell of a line is a number of this dialect."""
    row = [cell for cell in cells(line, dialect) if cell]
    return (
        bool(row)
        and all(is_number(cell, dialect) for cell in row)
        and (
            not dialect.is_complex
            or any(_COMPLEX.fullmatch(_pointed(cell, dialect)) for cell in row)
        )
    )


def is_number(cell: str, dialect: Dialect) -> bool:
    """Return whether a cell is a number of this dialect."""
    if len(cell) > _LONGEST_NUMBER or (dialect.decimal == "," and "." in cell):
        return False
    text = _pointed(cell, dialect)
    if _NUMBER.fullmatch(text):
        return True
    return dialect.is_complex and _COMPLEX.fullmatch(text) is not None


def _pointed(cell: str, dialect: Dialect) -> str:
    return cell.replace(",", ".") if dialect.decimal == "," else cell
