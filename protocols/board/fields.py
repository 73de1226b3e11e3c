"""How a field of a message stands on the wire, written beside the field of its record.

A record is a frozen dataclass whose annotations are of the form `Annotated[int, u32("words")]`,
in the order of the wire. From them come the Python codec (`layout.py`) and what
`python -m armodal.protocols.board.generate` writes: C, the tables of the document, test vectors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

__all__ = [
    "LIMITS",
    "Role",
    "Rule",
    "Wire",
    "WireType",
    "choice",
    "constant",
    "flag",
    "flags",
    "i32",
    "rational",
    "u8",
    "u16",
    "u32",
    "u64",
]

WireType = Literal["u8", "u16", "u32", "u64", "i32"]
Role = Literal["number", "flag", "choice", "flags", "constant", "rational"]

LIMITS: dict[WireType, tuple[int, int]] = {
    "u8": (0, 2**8 - 1),
    "u16": (0, 2**16 - 1),
    "u32": (0, 2**32 - 1),
    "u64": (0, 2**64 - 1),
    "i32": (-(2**31), 2**31 - 1),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Wire:
    """One field on the wire.

    type : integer on the wire, little endian; of a rational both of its parts
    words : meaning, for the document and the C header
    low, high : smallest and largest value a reader takes
    unit : of the value, empty where it has none
    role : what Python makes of the integer
    """

    type: WireType
    words: str
    low: int
    high: int
    unit: str = ""
    role: Role = "number"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """What must hold between the fields of a record.

    words : the rule, for the document and for who broke it
    holds : the rule of a record in Python
    c : the same in C, of a record `m`
    """

    words: str
    holds: Callable[[Any], bool]
    c: str


def _number(type_: WireType, words: str, low: int | None, high: int | None, unit: str) -> Wire:
    least, most = LIMITS[type_]
    return Wire(
        type=type_,
        words=words,
        low=least if low is None else low,
        high=most if high is None else high,
        unit=unit,
    )


def u8(words: str, *, low: int | None = None, high: int | None = None, unit: str = "") -> Wire:
    """A number of 8 bits, unsigned."""
    return _number("u8", words, low, high, unit)


def u16(words: str, *, low: int | None = None, high: int | None = None, unit: str = "") -> Wire:
    """A number of 16 bits, unsigned."""
    return _number("u16", words, low, high, unit)


def u32(words: str, *, low: int | None = None, high: int | None = None, unit: str = "") -> Wire:
    """A number of 32 bits, unsigned."""
    return _number("u32", words, low, high, unit)


def u64(words: str, *, low: int | None = None, high: int | None = None, unit: str = "") -> Wire:
    """A number of 64 bits, unsigned."""
    return _number("u64", words, low, high, unit)


def i32(words: str, *, low: int | None = None, high: int | None = None, unit: str = "") -> Wire:
    """A number of 32 bits, two's complement."""
    return _number("i32", words, low, high, unit)


def flag(words: str) -> Wire:
    """Yes or no: one byte, 1 or 0."""
    return Wire(type="u8", words=words, low=0, high=1, role="flag")


def choice(words: str) -> Wire:
    """A member of the field's `IntEnum`, in one byte."""
    least, most = LIMITS["u8"]
    return Wire(type="u8", words=words, low=least, high=most, role="choice")


def flags(words: str) -> Wire:
    """Bits of the field's `IntFlag`, in 16 bits; those it has no name for are ignored."""
    least, most = LIMITS["u16"]
    return Wire(type="u16", words=words, low=least, high=most, role="flags")


def constant(type_: WireType, value: int, words: str) -> Wire:
    """A number that is always the same; its field is a `ClassVar`."""
    return Wire(type=type_, words=words, low=value, high=value, role="constant")


def rational(words: str, *, unit: str = "") -> Wire:
    """A positive quotient of two u32, numerator first."""
    _, most = LIMITS["u32"]
    return Wire(type="u32", words=words, low=1, high=most, unit=unit, role="rational")
