"""Dataset 58 of a universal file: one function of time or frequency, in text or binary."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.foreign.uff_blocks import HEADER_LINES_58, MOST_VALUES, Block
from armodal.protocols.foreign.uff_fields import NODE_LIMIT, floats, integers, record, refuse_short
from armodal.protocols.foreign.uff_records import UffFunction

__all__ = ["function_58"]

_LONGEST_RECORD = 200  # characters, of 80
_MOST_SURPLUS = 5  # numbers that may pad the last record
_KINDS = {2, 4, 5, 6}  # real or complex, single or double
# Record 6 where a program shifted its columns: numbers, a name, numbers, a name, numbers.
_SHIFTED_6 = re.compile(
    r"\s*(-?\d+)\s+(-?\d+)\s+(-?\d+)\s+(-?\d+)\s+(.*?)\s*(?<!\S)(-?\d+)\s+(-?\d+)\s+(.*?)\s*"
    r"(?<!\S)(-?\d+)\s+(-?\d+)\s*"
)


def function_58(block: Block, origin: str) -> UffFunction:
    """Read a function.

    Raises
    ------
    ForeignFileError
        If a record of the header is none, or values are missing.
    """
    if len(block.lines) < HEADER_LINES_58:
        raise refuse_short(block, origin, HEADER_LINES_58)
    kind, points, spacing, first, step = _record_7(block, origin)
    is_complex, even = kind >= 5, spacing == 1
    per_point = (2 if is_complex else 1) + (0 if even else 1)
    if block.binary is not None:
        numbers = np.frombuffer(block.binary, dtype="<f8")
    else:
        width = 20 if kind in {4, 6} else 13
        body = block.lines[HEADER_LINES_58:]
        numbers = floats(block, body, width, origin, "values")
    surplus = len(numbers) - points * per_point
    if surplus < 0 or surplus > _MOST_SURPLUS:
        came = f"{len(numbers) / per_point:g}"
        raise block.refuse(origin, f"{points} values, as record 7 announces", came)
    rows = numbers[: points * per_point].reshape(points, per_point)
    abscissa = first + step * np.arange(points) if even else rows[:, 0]
    ordinate = rows if even else rows[:, 1:]
    values: npt.NDArray[np.float64] | npt.NDArray[np.complex128]
    values = (
        frozen_array(ordinate[:, 0] + 1j * ordinate[:, 1], np.complex128)
        if is_complex
        else frozen_array(ordinate[:, 0], np.float64)
    )
    function, version, response, reference = _record_6(block, origin)
    numerator, numerator_unit = _axis(block, 8, origin)
    denominator, denominator_unit = _axis(block, 9, origin)
    return UffFunction(
        kind=function,
        response_node=response[0],
        response_direction=response[1],
        reference_node=reference[0],
        reference_direction=reference[1],
        abscissa=frozen_array(abscissa, np.float64),
        values=values,
        even=even,
        numerator=numerator,
        denominator=denominator,
        numerator_unit=numerator_unit,
        denominator_unit=denominator_unit,
        abscissa_kind=_axis(block, 7, origin)[0],
        version=version,
        identification=tuple(line.strip() for line in block.lines[:5]),
    )


def _record_7(block: Block, origin: str) -> tuple[int, int, int, float, float]:
    line = record(block, 6)
    parts = line.split()
    if len(parts) < 5:
        widths = (10, 10, 10, 13, 13)
        parts = [line[sum(widths[:i]) : sum(widths[: i + 1])] for i in range(5)]
    try:
        kind, points, spacing = (int(part) for part in parts[:3])
        first, step = (float(part.replace("D", "E") or 0.0) for part in parts[3:5])
    except ValueError as error:
        raise block.refuse(origin, "whole numbers in record 7", repr(line[:56])) from error
    if kind not in _KINDS or spacing not in {0, 1} or not 0 < points <= MOST_VALUES:
        came = f"{kind}, {points}, {spacing}"
        raise block.refuse(origin, "ordinate type, number of points and spacing", came)
    if not (np.isfinite(first) and np.isfinite(step)):
        raise block.refuse(origin, "a finite abscissa", f"{first}, {step}")
    return kind, points, spacing, first, step


def _record_6(block: Block, origin: str) -> tuple[int, int, tuple[int, int], tuple[int, int]]:
    """Return function type, version, and node and direction of response and reference."""
    line = record(block, 5)[:_LONGEST_RECORD]
    columns = ((0, 5), (15, 20), (41, 51), (51, 55), (66, 76), (76, 80))
    try:
        cut = [line[a:b].strip() for a, b in columns]
        numbers = [int(text) if text else 0 for text in cut]
    except ValueError as error:
        match = _SHIFTED_6.fullmatch(line)
        if match is None:
            came = repr(line[:80])
            raise block.refuse(origin, "numbers and names in record 6", came) from error
        numbers = [int(match[i]) for i in (1, 3, 6, 7, 9, 10)]
    function, version, node, direction, other_node, other_direction = numbers
    # A node below 0 is a channel that has none, as analysers write it.
    for one in (node, other_node):
        if one >= NODE_LIMIT:
            raise block.refuse(origin, "a node number below 2^31", str(one))
    for one in (direction, other_direction):
        if not -6 <= one <= 6:
            raise block.refuse(origin, "a direction from -6 to 6", str(one))
    return function, version, (max(node, 0), direction), (max(other_node, 0), other_direction)


def _axis(block: Block, index: int, origin: str) -> tuple[int, str]:
    """Return data type and unit of a record I10, 3I5, 2(1X, 20A1)."""
    line = record(block, index)
    (kind,) = integers(Block(block.number, 58, (line[:10],)), 0, (10,), origin, "data type")
    label = line[47:67].strip()
    return kind, "" if label.upper() == "NONE" else label
