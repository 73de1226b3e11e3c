"""Whole-byte fields of a CAN frame, in every order and kind a number can have there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

__all__ = ["Field", "FieldFormat", "Kind", "fields_of", "formats"]

Array = npt.NDArray[np.float64]


LARGEST_ANGLE = 1e12  # beyond, four bytes are no angle in any unit


class Kind(StrEnum):
    """How the bytes are read."""

    SIGNED = "signed"
    UNSIGNED = "unsigned"
    FLOAT = "float"


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldFormat:
    """Size, order and kind."""

    n_bytes: int
    little_endian: bool
    kind: Kind

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest number it holds."""
        bits = 8 * self.n_bytes
        if self.kind is Kind.FLOAT:
            return -np.inf, np.inf
        if self.kind is Kind.SIGNED:
            return -(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1.0
        return 0.0, 2.0**bits - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A number in the frames of one identifier."""

    can_id: int
    extended: bool
    first_byte: int
    format: FieldFormat

    @property
    def bytes(self) -> frozenset[int]:
        """Which bytes it takes."""
        return frozenset(range(self.first_byte, self.first_byte + self.format.n_bytes))

    def overlaps(self, other: Field) -> bool:
        """Whether both take a byte of the same frame."""
        same = (self.can_id, self.extended) == (other.can_id, other.extended)
        return same and bool(self.bytes & other.bytes)

    def read(self, data: npt.NDArray[np.uint8]) -> Array:
        """(n,) numbers of frames (n, length); what is no number is nan."""
        part = data[:, self.first_byte : self.first_byte + self.format.n_bytes]
        if not self.format.little_endian:
            part = part[:, ::-1]
        if self.format.kind is Kind.FLOAT:
            raw = np.ascontiguousarray(part).view(f"<f{self.format.n_bytes}")[:, 0]
            with np.errstate(invalid="ignore"):
                numbers: Array = raw.astype(np.float64)
                return np.where(np.abs(numbers) < LARGEST_ANGLE, numbers, np.nan)
        weights = 256.0 ** np.arange(self.format.n_bytes)
        value: Array = part.astype(np.float64) @ weights
        if self.format.kind is Kind.SIGNED:
            span = 256.0**self.format.n_bytes
            value = np.where(value >= span / 2.0, value - span, value)
        return value

    def words(self) -> str:
        """Where it is and how it is read."""
        first, n = self.first_byte, self.format.n_bytes
        order = "little endian" if self.format.little_endian else "big endian"
        where = f"bytes {first} to {first + n - 1}"
        return f"0x{self.can_id:x} {where}, {self.format.kind} {8 * n} bit, {order}"


def formats() -> Iterator[FieldFormat]:
    """Every format, the widest first; whole numbers of two, three, four and eight bytes, floats."""
    for n_bytes in (8, 4, 3, 2):
        for kind in Kind:
            if kind is Kind.FLOAT and n_bytes not in (4, 8):
                continue
            for little_endian in (True, False):
                yield FieldFormat(n_bytes=n_bytes, little_endian=little_endian, kind=kind)


def fields_of(can_id: int, extended: bool, length: int, form: FieldFormat) -> Iterator[Field]:
    """Every place of a format in a frame of some length."""
    for first in range(length - form.n_bytes + 1):
        yield Field(can_id=can_id, extended=extended, first_byte=first, format=form)
