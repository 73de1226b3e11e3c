"""A universal file taken apart into datasets, before any of them is trusted.

A dataset stands between two lines `    -1`. Binary data (58b) may hold those bytes by chance, so
its length is worked out from its own header and the closing line is asked for at that place.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.os_words import os_words

__all__ = ["Block", "read_foreign_bytes", "split_blocks"]

LARGEST_FILE = 2**30
MOST_BLOCKS = 100_000
MOST_VALUES = 2**24  # of one function
_MOST_LINES_BEFORE = 20  # a title, or a page's heading
HEADER_LINES_58 = 11  # id lines 1-5, records 6-11

_MARK = re.compile(rb"[ \t]*-1[ \t]*\r?\n?")
_WORDS = re.compile(rb"[ \t]*[A-Za-z]{3}")
_TYPE = re.compile(rb"[ \t]*(\d{1,6})(b?)[ \t]*(.*)", re.IGNORECASE | re.DOTALL)
_VALUES = {2: (1, 4), 4: (1, 8), 5: (2, 4), 6: (2, 8)}  # numbers a point, bytes a number


@dataclass(frozen=True, slots=True)
class Block:
    """One dataset: its type, its lines, and for 58b its numbers as float64."""

    number: int  # in the file, from 1
    type: int
    lines: tuple[str, ...]  # after the line of the type; only the header's for 58b
    binary: bytes | None = None  # little-endian float64

    def refuse(self, origin: str, wanted: str, came: str) -> ForeignFileError:
        """Return the error about this dataset."""
        return ForeignFileError(
            f"{origin}: dataset {self.number} (type {self.type}): wanted {wanted}, {came} came; "
            "export the file again"
        )


def read_foreign_bytes(path: Path, *, limit: int = LARGEST_FILE) -> bytes:
    """Read a file whole, if it is a plain file of at most `limit` bytes; else ForeignFileError."""
    try:
        there = path.is_file()
    except ValueError:  # a name that no file can have
        there = False
    if not there:
        raise ForeignFileError(f"{path}: wanted a readable file, found none; check the path")
    try:
        with path.open("rb") as file:
            size = os.fstat(file.fileno()).st_size  # read() takes room for what it is told
            data = file.read(min(size, limit) + 1)
    except OSError as error:
        raise ForeignFileError(
            f"{path}: cannot be read ({os_words(error)}); check the path"
        ) from error
    if len(data) > limit:
        raise ForeignFileError(
            f"{path.name}: wanted at most {limit} bytes, got more; split the file"
        )
    return data


def split_blocks(data: bytes, origin: str) -> tuple[list[Block], list[str]]:
    """Part the bytes of a universal file into its datasets, and tell cosmetic faults.

    Parameters
    ----------
    data
        The whole file.
    origin
        How messages name it.

    Raises
    ------
    ForeignFileError
        If there is no dataset, or one is not closed, is announced wrongly, or is followed by
        something that is none.
    """
    blocks: list[Block] = []
    at = _first_mark(data)
    notes = ["lines before the first dataset are passed over"] if at else []
    while True:
        at = _skip_blank(data, at)
        if at >= len(data):
            break
        line, after = _line(data, at)
        if blocks and _WORDS.match(line) and not _mark_behind(data, at):
            notes.append("lines behind the last dataset are passed over")
            break
        if not _MARK.fullmatch(line):
            what = "no universal file" if not blocks else "something between datasets"
            raise ForeignFileError(
                f"{origin}: byte {at}: wanted a line `    -1` that opens a dataset, "
                f"{line[:40]!r} came: {what}; export it again as a universal file"
            )
        if len(blocks) >= MOST_BLOCKS:
            raise ForeignFileError(f"{origin}: wanted at most {MOST_BLOCKS} datasets, got more")
        block, at = _block(data, after, len(blocks) + 1, origin)
        blocks.append(block)
    if not blocks:
        raise ForeignFileError(f"{origin}: wanted datasets, got an empty file; export it again")
    return blocks, notes


def _first_mark(data: bytes) -> int:
    """Return where the first dataset opens, 0 where none does within the first lines."""
    at = 0
    for _ in range(_MOST_LINES_BEFORE):
        line, after = _line(data, at)
        if _MARK.fullmatch(line.removeprefix(b"\xef\xbb\xbf")) and line.strip():
            return at + (3 if line.startswith(b"\xef\xbb\xbf") else 0)
        if after >= len(data):
            break
        at = after
    return 0


def _mark_behind(data: bytes, at: int) -> bool:
    """Whether a line that opens or closes a dataset follows."""
    return re.search(rb"^ {4}-1[ \t]*\r?$", data[at:], re.MULTILINE) is not None


def _block(data: bytes, at: int, number: int, origin: str) -> tuple[Block, int]:
    line, after = _line(data, at)
    match = _TYPE.fullmatch(line.rstrip(b"\r\n"))
    if match is None:
        raise _cut(origin, number, f"{line[:40]!r} came where the type of a dataset stands")
    type_, binary = int(match[1]), bool(match[2])
    if binary and type_ != 58:
        raise ForeignFileError(
            f"{origin}: dataset {number}: binary data are read from 58b only, {type_}b came; "
            "export it as text"
        )
    if binary:
        return _binary_block(data, after, number, match[3], origin)
    return _text_block(data, after, number, type_, origin)


def _text_block(data: bytes, at: int, number: int, type_: int, origin: str) -> tuple[Block, int]:
    lines: list[str] = []
    while at < len(data):
        line, after = _line(data, at)
        # A line of data may be `-1` alone, but only dataset 58's single value would be so short;
        # the mark has it in columns 5 and 6.
        if _MARK.fullmatch(line) and line.rstrip() == b"    -1":
            return Block(number, type_, tuple(lines)), after
        lines.append(_decoded(line))
        at = after
    raise _cut(origin, number, "the file ends inside it")


def _binary_block(data: bytes, at: int, number: int, rest: bytes, origin: str) -> tuple[Block, int]:
    lines: list[str] = []
    for _ in range(HEADER_LINES_58):
        if at >= len(data):
            raise _cut(origin, number, "the file ends inside its header")
        line, at = _line(data, at)
        lines.append(_decoded(line))
    head = Block(number, 58, tuple(lines))
    try:
        fields = [int(text) for text in rest.split()[:2]]
        kind, points, spacing = (int(lines[6][i : i + 10]) for i in (0, 10, 20))
    except ValueError as error:
        raise head.refuse(origin, "whole numbers in a 58b header", str(error)) from error
    if len(fields) != 2 or fields[0] not in {1, 2} or fields[1] != 2:
        raise head.refuse(
            origin, "byte order 1 or 2 and IEEE numbers (2)", " ".join(map(str, fields)) or "none"
        )
    if kind not in _VALUES or not 0 < points <= MOST_VALUES or spacing not in {0, 1}:
        came = f"{kind}, {points}, {spacing}"
        raise head.refuse(origin, "ordinate type, number of points and spacing", came)
    order = "<" if fields[0] == 1 else ">"
    per_point, size = _VALUES[kind]
    fields_of_point = [("y", f"{order}f{size}", (per_point,))]
    layouts = [np.dtype(fields_of_point)]
    if not spacing:
        # The format has the abscissa in single precision; some programs write it as the ordinate.
        layouts = [
            np.dtype([("x", f"{order}f{width}", (1,)), *fields_of_point])
            for width in dict.fromkeys((size, 4))
        ]
    for layout in layouts:
        end = at + points * layout.itemsize
        closing = _closing(data, end)
        if closing is not None:
            rows = np.frombuffer(data, dtype=layout, count=points, offset=at)
            parts = [rows[name].astype("<f8") for name in layout.names or ()]
            binary = np.concatenate(parts, axis=1).tobytes()
            return Block(number, 58, tuple(lines), binary), closing
    wanted = points * layouts[0].itemsize
    raise _cut(
        origin,
        number,
        f"no closing line `    -1` follows the {wanted} bytes that its header announces "
        f"({len(data) - at} bytes are left in the file)",
    )


def _closing(data: bytes, at: int) -> int | None:
    """Position behind the closing line that stands at `at`, or None."""
    if at > len(data):
        return None
    for gap in (b"", b"\n", b"\r\n", b"\r"):
        if data.startswith(gap + b"    -1", at):
            line, after = _line(data, at + len(gap))
            if _MARK.fullmatch(line):
                return after
    return None


def _decoded(line: bytes) -> str:
    try:
        return line.decode("utf-8").rstrip("\r\n")
    except UnicodeDecodeError:
        return line.decode("latin-1").rstrip("\r\n")


def _line(data: bytes, at: int) -> tuple[bytes, int]:
    """Return the line at `at`, its end included, and where the next one begins."""
    end = data.find(b"\n", at)
    after = len(data) if end < 0 else end + 1
    return data[at:after], after


def _skip_blank(data: bytes, at: int) -> int:
    while at < len(data):
        line, after = _line(data, at)
        if line.strip(b" \t\r\n\x00\x1a"):
            return at
        at = after
    return at


def _cut(origin: str, number: int, came: str) -> ForeignFileError:
    return ForeignFileError(
        f"{origin}: dataset {number}: wanted a whole dataset, {came}: the file is truncated or "
        "damaged; export it again"
    )
