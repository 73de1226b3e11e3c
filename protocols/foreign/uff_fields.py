"""Numbers in the records of a universal file: by their columns, or parted by blanks.

The format gives every field its columns. Programs shift them, or let two numbers touch; so a
record is split at its blanks where that gives as many fields as it should have, else cut at its
columns.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_blocks import Block

__all__ = ["NODE_LIMIT", "floats", "integers", "node_numbers", "record", "refuse_short"]

NODE_LIMIT = 2**31


def record(block: Block, index: int) -> str:
    """Return a record, empty where the dataset is shorter."""
    return block.lines[index].expandtabs() if index < len(block.lines) else ""


def integers(block: Block, index: int, widths: Sequence[int], origin: str, what: str) -> list[int]:
    """Return the whole numbers of a record; blank fields are 0.

    Raises
    ------
    ForeignFileError
        If a field is no whole number.
    """
    line = record(block, index)
    parts = line.split()
    if len(parts) != len(widths):
        parts = _cut(line, widths)
    try:
        return [int(part) if part.strip() else 0 for part in parts]
    except ValueError as error:
        raise block.refuse(origin, f"whole numbers as {what}", repr(line[:40])) from error


def floats(
    block: Block, lines: Sequence[str], width: int, origin: str, what: str
) -> npt.NDArray[np.float64]:
    """Return all numbers in records of fields of one width.

    Raises
    ------
    ForeignFileError
        If a field is no number.
    """
    text = "\n".join(lines)
    if "D" in text or "d" in text:
        text = text.replace("D", "E").replace("d", "E")
    with suppress(ValueError, DeprecationWarning), warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of numpy before 2.3, for a bad number
        return np.asarray(np.fromstring(text, sep=" "), dtype=np.float64)
    rows = [line.rstrip() for line in text.split("\n")]
    parts = [row[i : i + width] for row in rows for i in range(0, len(row), width)]
    try:
        return np.array(parts, dtype=np.float64)
    except ValueError as error:
        raise block.refuse(origin, f"numbers as {what}", str(error)[:60]) from error


def node_numbers(block: Block, origin: str, values: Any) -> npt.NDArray[np.int64]:
    """Return node numbers, each whole and below 2^31, or refuse the dataset."""
    numbers = np.asarray(values, dtype=np.float64).reshape(-1)
    if not (np.isfinite(numbers).all() and (numbers == np.round(numbers)).all()):
        raise block.refuse(origin, "whole numbers as node numbers", "others")
    if (numbers < 0).any() or (numbers >= NODE_LIMIT).any():
        raise block.refuse(origin, "node numbers from 0 to 2^31", "others")
    return frozen_array(numbers.astype(np.int64), np.int64)


def _cut(line: str, widths: Sequence[int]) -> list[str]:
    parts = []
    at = 0
    for width in widths:
        parts.append(line[at : at + width])
        at += width
    return parts


def refuse_short(block: Block, origin: str, wanted: int) -> ForeignFileError:
    """Return the error about a dataset of too few records."""
    return block.refuse(origin, f"{wanted} records", str(len(block.lines)))
