"""LabVIEW measurement files (.lvm): a header of the file, then sections of channels.

Each section has a header of its own (`Channels`, `Samples`, `Y_Unit_Label`, `X0`, `Delta_X`, …),
a line of names that begins with `X_Value`, and rows. With `X_Columns` `No` the first cell of a
row is empty; with `One` there is one column of X, with `Multi` one before each channel. The
decimal sign is told, or is that of the numbers.

References
----------
National Instruments, Specification for the LabVIEW Measurement File (.lvm).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.text_dialect import Dialect, cells, encoding_of, is_number
from armodal.protocols.foreign.text_table import numbers_of_rows
from armodal.protocols.foreign.variables import Axis, Listed, Variable, Variables

__all__ = ["LVM_SIGN", "lvm_variables"]

LVM_SIGN = "LabVIEW Measurement"
_END = "***End_of_Header***"
_MOST_SECTIONS = 1000
_MOST_CHANNELS = 1000
_TIMES = {"", "time"}
_COUNT = re.compile(r"[0-9]{1,18}")


@dataclass(frozen=True, slots=True)
class _Section:
    """A section's header by its keys, and where its names stand."""

    header: dict[str, list[str]]
    names_at: int


def lvm_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the sections of a LabVIEW measurement file.

    Raises
    ------
    ForeignFileError
        If it is truncated, or a header does not fit the numbers behind it.
    """
    text = data.decode(encoding_of(data, origin), errors="replace")
    lines = text.split("\n")
    if not lines[0].strip().startswith(LVM_SIGN):
        raise ForeignFileError(f"{origin}: wanted a LabVIEW measurement file, got another")
    told = _keys(lines, 1, "\t")
    separator = {"tab": "\t", "comma": ","}.get(told.get("Separator", ["Tab"])[0].lower(), "\t")
    decimal = told.get("Decimal_Separator", [""])[0]
    if separator != "\t":
        decimal = "."
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    sections = [_header_before(lines, end, separator) for end in ends[1:]]
    if not sections or len(sections) > _MOST_SECTIONS:
        raise ForeignFileError(
            f"{origin}: wanted the header of 1 to {_MOST_SECTIONS} sections, got {len(sections)}: "
            "the file is truncated or damaged; save it again"
        )
    parts = []
    for i, section in enumerate(sections):
        stop = ends[i + 2] if i + 2 < len(ends) else len(lines)
        where = origin if len(sections) == 1 else f"{origin}: section {i + 1}"
        rows = lines[section.names_at + 1 : stop]
        names = lines[section.names_at] if section.names_at < len(lines) else ""
        parts.append(_section(section, names, rows, separator, decimal, where))
    return tuple(parts)


def _keys(lines: Sequence[str], at: int, separator: str) -> dict[str, list[str]]:
    """Return the keys of a header with their values, at least an empty one, up to its end."""
    found: dict[str, list[str]] = {}
    for line in lines[at : at + 100]:
        if line.startswith(_END):
            break
        key, *values = line.rstrip("\r\n").split(separator)
        found.setdefault(key.strip(), [value.strip() for value in values] or [""])
    return found


def _header_before(lines: Sequence[str], end: int, separator: str) -> _Section:
    at = end
    while at > 0 and not lines[at].startswith("Channels"):
        at -= 1
    return _Section(_keys(lines, at, separator), end + 1)


def _section(
    section: _Section,
    names_line: str,
    lines: Sequence[str],
    separator: str,
    decimal: str,
    origin: str,
) -> Variables:
    header = section.header
    names = [cell.strip() for cell in names_line.rstrip("\r\n").split(separator)]
    rows = [line for line in lines if _is_numbers(line, separator, decimal)]
    if not rows or len(names) < 2 or len(names) > _MOST_CHANNELS:
        raise ForeignFileError(
            f"{origin}: wanted a line of names and rows of numbers, got {len(rows)} rows under "
            f"{len(names)} names: the file is truncated or damaged; save it again"
        )
    decimal = decimal or _decimal(rows[0], separator)
    dialect = Dialect(delimiter=separator, decimal=decimal)
    first = [cell.strip() for cell in rows[0].rstrip("\r\n").split(separator)]
    if len(first) < len(names) - (names[-1] == "Comment"):
        raise _short(origin, len(first), len(names))
    filled = [
        i for i, name in enumerate(names) if name != "Comment" and i < len(first) and first[i]
    ]
    if not filled:
        raise _short(origin, 0, len(names))
    table = numbers_of_rows(iter(rows), rows[0], filled, dialect, origin)
    announced = _announced(header)
    if announced is not None and len(table) < announced:
        raise ForeignFileError(
            f"{origin}: wanted {announced} samples, as the header announces, got {len(table)}: "
            "the file is truncated or damaged; save it again"
        )
    units = _by_channel(header.get("Y_Unit_Label", []), names)
    columns = dict(zip(filled, table.T, strict=True))
    is_time = header.get("X_Dimension", [""])[0].strip().lower() in _TIMES
    axis_name = "time" if is_time else header["X_Dimension"][0]
    variables = tuple(
        Variable(name=axis_name, values=column, unit="s" if is_time else "")
        if names[i] == "X_Value"
        else Variable(name=names[i] or f"channel {i}", values=column, unit=units.get(i, ""))
        for i, column in columns.items()
    )
    empty = [name for i, name in enumerate(names) if name and i not in filled]
    return Variables(
        origin=origin,
        format="LabVIEW measurement",
        variables=variables,
        axis=_axis(header, decimal, origin) if 0 not in filled else None,
        others=tuple(
            Listed(name=name, shape=(0,), type="empty")
            for name in empty
            if name not in {"Comment", "X_Value"}
        ),
    )


def _is_numbers(line: str, separator: str, decimal: str) -> bool:
    """Whether a line is a row: its first filled cell is a number."""
    dialect = Dialect(delimiter=separator, decimal=decimal or ".")
    other = Dialect(delimiter=separator, decimal=",")
    first = next((cell for cell in cells(line, dialect) if cell), "")
    return is_number(first, dialect) or is_number(first, other)


def _decimal(row: str, separator: str) -> str:
    return "," if separator == "\t" and "," in row and "." not in row else "."


def _short(origin: str, came: int, wanted: int) -> ForeignFileError:
    return ForeignFileError(
        f"{origin}: wanted rows of {wanted} cells, as the line of names has, got {came}: the file "
        "is truncated or damaged; save it again"
    )


def _announced(header: dict[str, list[str]]) -> int | None:
    """Return the fewest samples that a filled channel has by the header, None if it tells none.

    A stream that LabVIEW appends to has the samples of its first piece there.
    """
    told = [int(text) for text in header.get("Samples", []) if _COUNT.fullmatch(text)]
    told = [number for number in told if number > 0]
    return min(told) if told else None


def _by_channel(values: Sequence[str], names: Sequence[str]) -> dict[int, str]:
    """Return units by the place of the name they belong to.

    The header has a value for each name behind the first `X_Value`.
    """
    return {i + 1: value for i, value in enumerate(values) if value and i + 1 < len(names)}


def _axis(header: dict[str, list[str]], decimal: str, origin: str) -> Axis:
    printed = [text for text in header.get("Delta_X", []) if text]
    steps = [_number(text, decimal) for text in printed]
    firsts = [_number(text, decimal) for text in header.get("X0", []) if text]
    if not steps or not np.isfinite(steps[0]) or steps[0] <= 0.0 or len(set(steps)) > 1:
        raise ForeignFileError(
            f"{origin}: wanted one Delta_X above 0 for all channels, got "
            f"{', '.join(printed[:4]) or 'none'}; save the channels at one rate"
        )
    dimension = header.get("X_Dimension", [""])[0].strip().lower()
    return Axis(
        unit="s" if dimension in _TIMES else "Hz",
        first=firsts[0] if firsts and np.isfinite(firsts[0]) else 0.0,
        step=steps[0],
        rounding=_rounding(printed[0], steps[0]),
    )


def _rounding(printed: str, value: float) -> float:
    """Return half of the last digit printed, relative to the value.

    >>> round(_rounding("0.000977", 0.000977), 6)
    0.000512
    """
    mantissa, _, exponent = printed.upper().replace(",", ".").partition("E")
    decimals = len(mantissa.partition(".")[2])
    return float(0.5 * 10.0 ** (int(exponent or 0) - decimals) / value)


def _number(text: str, decimal: str) -> float:
    plain = text.replace(",", ".") if decimal == "," or "." not in text else text
    try:
        return float(plain)
    except ValueError:
        return float("nan")
