"""The header of a text table: names and units of its columns, and facts in words.

Analysers write the names in one line, the units in brackets behind them or in a line of their
own; others write a fact a line, such as `X-axis unit: Hz` or `Sampling(Hz),5000`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from armodal.protocols.foreign.frf_dofs import told_dof
from armodal.protocols.foreign.roles import Role, is_unit, role_of, split_unit
from armodal.protocols.foreign.text_dialect import Dialect, is_number
from armodal.protocols.foreign.units import hertz, seconds

__all__ = ["Header", "read_header"]

_COMMENT = re.compile(r"^\s*(?:[#%!*]|//)+\s?")
_SEPARATOR = re.compile(r"[:=\t;,]")
_NUMBER_AND_UNIT = re.compile(r"([+-]?[\d.,]+(?:[eE][+-]?\d+)?)\s*(\S*)")
_LABELS = {"unit", "units", "einheit", "einheiten", "unité", "y_unit_label", "dimension"}
_NAME_LABELS = {"ch no", "ch no.", "ch name", "channel", "channels", "name", "kanal", "no", "ch"}
_LONGEST_FACT, _LONGEST_NAME = 400, 200  # characters
# Of Testlab's text files.
_FACTS = {
    "dof id": "responses",
    "reference dof id": "references",
    "number of averages": "averages",
}
_LETTERS = re.compile(r"[^\W\d_]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """What a header tells; names and units are empty where it tells none."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    words: str
    x_unit: str = ""
    y_unit: str = ""
    rate_hz: float | None = None
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def read_header(lines: Sequence[str], columns: Sequence[int], dialect: Dialect) -> Header:
    """Read the lines before the numbers.

    Parameters
    ----------
    lines
        The header.
    columns
        Places of the filled cells in a row of numbers.
    dialect
        How rows are written.
    """
    clean = [_COMMENT.sub("", line).rstrip("\r\n") for line in lines]
    rows: list[tuple[str, ...]] = []
    units = ("",) * len(columns)
    for line in reversed(clean):
        row = _row(line, columns, dialect)
        if row is None:
            continue
        label_of_units = row[0].strip("[]:. ").lower() in _LABELS
        if all(not cell or is_unit(_bare(cell)) for cell in row[label_of_units:]):
            if not any(units):
                told = ["" if label_of_units else row[0], *row[1:]]
                units = tuple(_bare(cell) for cell in told)
        elif _are_names(row, dialect):
            rows.append(row)
    names = _best(rows)
    parted = [split_unit(name) for name in names]
    if names:
        units = tuple(own or below for (_, own), below in zip(parted, units, strict=True))
    facts = _facts(clean)
    return Header(
        names=tuple(name for name, _ in parted),
        units=units,
        words=" ".join(clean)[:4000],
        x_unit=facts.get("x", ""),
        y_unit=facts.get("y", ""),
        rate_hz=_rate(clean),
        texts=_told(clean),
    )


def _best(rows: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the row of names: one that is called so or begins with an axis, else the last."""
    for row in rows:
        first = row[0].strip("[]:. ").lower()
        if first in _NAME_LABELS:
            return ("", *row[1:])
        bare, label = split_unit(row[0])
        if role_of(bare, label, is_complex=False) in {Role.TIME, Role.FREQUENCY}:
            return row
    return rows[0] if rows else ()


def _bare(cell: str) -> str:
    text = cell.strip()
    if text[:1] + text[-1:] == "[]":
        return text[1:-1].strip()
    return text


def _row(line: str, columns: Sequence[int], dialect: Dialect) -> tuple[str, ...] | None:
    """Return a line's cells at the columns of the numbers; None where it has others."""
    if not line.strip():
        return None
    n = columns[-1] + 1
    for parts in _splits(line, dialect):
        row = [part.strip().strip("\"'").strip()[:_LONGEST_NAME] for part in parts]
        if len(row) == len(columns) != n and all(row):
            return tuple(row)
        while len(row) > n and not row[-1]:
            row.pop()
        if len(row) == n or (n > 1 and len(row) == n - 1):
            row += [""] * (n - len(row))
            return tuple(row[i] for i in columns)
    return None


def _splits(line: str, dialect: Dialect) -> list[list[str]]:
    if dialect.delimiter is not None:
        return [line.split(dialect.delimiter)]
    text = line.strip()
    # "Time [s]  Force [N]" and "Time [s] Force [N]": blanks part names, not a unit from its name.
    return [
        text.split("\t"),
        re.split(r"\s{2,}", text),
        re.split(r"\s+(?![\[(])", text),
        re.split(r"\s*[,;]\s*", text),
    ]


def _are_names(row: Sequence[str], dialect: Dialect) -> bool:
    filled = [cell for cell in row if cell]
    wordy = [cell for cell in filled if _LETTERS.search(cell)]
    numbers = [cell for cell in filled if is_number(cell, dialect)]
    # "Resolution<tab>1 Hz" above three columns is a fact: it has no name for the third.
    complete = all(row[1:]) or len(row) == 1
    return (
        complete
        and 2 * len(wordy) > len(row)
        and not numbers
        and len(set(filled)) > len(filled) // 2
    )


def _facts(lines: Sequence[str]) -> dict[str, str]:
    """Return the units of the axes that lines such as `X-Axis unit: Hz` tell."""
    found: dict[str, str] = {}
    for line in lines:
        key, value = _fact(line)
        value = _bare(value)
        if "unit" not in key or not value:
            continue
        if hertz(value) or seconds(value):  # an axis', whatever it is called
            found.setdefault("x", value)
        elif not re.search(r"\bx\b|x-axis|x axis", key) and is_unit(value):
            found.setdefault("y", value)
    return found


def _told(lines: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Return points, directions and averages that lines such as `DOF id: Tool:3:-Z` tell."""
    found: dict[str, tuple[str, ...]] = {}
    for line in lines:
        key, value = _fact(line)
        what = _FACTS.get(key)
        text = value if what == "averages" and value.isdecimal() else told_dof(value)
        if what is not None and text:
            found.setdefault(what, (text,))
    return found


def _fact(line: str) -> tuple[str, str]:
    """Part a line such as `X-Axis unit: Hz` into a key, in small letters, and its value."""
    key, *value = _SEPARATOR.split(line[:_LONGEST_FACT], maxsplit=1)
    return key.strip(' "').lower(), value[0].strip(' "\t:=;,') if value else ""


def _rate(lines: Sequence[str]) -> float | None:
    """Return the sampling rate that a line tells, Hz."""
    for line in lines:
        key, value = _fact(line)
        number = _NUMBER_AND_UNIT.match(value)
        if number is None or not re.search(r"sampl|abtast", key):
            continue
        _, unit_of_key = split_unit(key)
        factor = hertz(number[2] or unit_of_key or "")
        try:
            rate = float(number[1].replace(",", ".")) * (factor or 0.0)
        except ValueError:
            continue
        if rate > 0.0:
            return rate
    return None
