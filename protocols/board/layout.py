"""The bytes of a record, derived from its annotations (`fields.py`): both directions and checks."""

from __future__ import annotations

import struct
from collections.abc import Callable, Container, Iterator
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from functools import cache
from typing import Any, ClassVar, TypeVar, get_args, get_origin, get_type_hints

from armodal.protocols.board.fields import LIMITS, Rule, Wire
from armodal.protocols.errors import FrameError

__all__ = ["Field", "Layout", "decode", "decode_head", "encode", "layout_of"]

Record = TypeVar("Record")

_CODES = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i32": "i"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """One field of a record on the wire; `python` is its type there, `offset` in bytes."""

    name: str
    python: type
    wire: Wire
    offset: int

    @property
    def numbers(self) -> tuple[tuple[str, int], ...]:
        """Name and offset of each number on the wire: two of a quotient, else one."""
        if self.wire.role != "rational":
            return ((self.name, self.offset),)
        size = struct.calcsize(_CODES[self.wire.type])
        return (
            (f"{self.name}_numerator", self.offset),
            (f"{self.name}_denominator", self.offset + size),
        )

    @property
    def range(self) -> str:
        """Values a reader takes, in words; empty where all that fit are."""
        low, high = self.wire.low, self.wire.high
        if self.wire.role == "choice":
            return ", ".join(f"{int(member)} {member.name}" for member in self.members)
        if self.wire.role == "flag":
            return "0 or 1"
        if low == high:
            return str(low)
        least, most = LIMITS[self.wire.type]
        if high != most:
            return f"{low}...{high}"
        return f"{low} or more" if low != least else ""

    @property
    def members(self) -> tuple[IntEnum, ...]:
        """Members of the enumeration of a choice."""
        return tuple(self.python) if issubclass(self.python, IntEnum) else ()

    @property
    def is_stored(self) -> bool:
        """Whether the record has the field; a constant stands on the wire alone."""
        return self.wire.role != "constant"

    def to_wire(self, record: object) -> tuple[int, ...]:
        """Numbers of a record's field."""
        if self.wire.role == "constant":
            return (self.wire.low,)
        value: Any = getattr(record, self.name)
        if self.wire.role == "rational":
            return (value.numerator, value.denominator)
        return (int(value),)

    @property
    def allowed(self) -> Container[int]:
        """Numbers that a reader takes."""
        if self.wire.role == "choice":
            return frozenset(int(member) for member in self.members)
        return range(self.wire.low, self.wire.high + 1)

    @property
    def from_wire(self) -> Callable[..., object] | None:
        """What makes the field's value of its numbers; None where the number itself is it."""
        kind: Callable[..., object] = self.python
        if issubclass(self.python, IntFlag):
            known = sum(self.python)
            return lambda bits: kind(bits & known)
        return None if self.python is int else kind


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """A record on the wire.

    checks : of each number on the wire its name, what it may be, and that in words
    makers : of each field of the record its name, the place of its numbers, and `from_wire`
    """

    record: type
    fields: tuple[Field, ...]
    rules: tuple[Rule, ...]
    form: struct.Struct
    checks: tuple[tuple[str, Container[int], str], ...]
    makers: tuple[tuple[str, slice, Callable[..., object] | None], ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return self.form.size


def _fields_of(record: type) -> Iterator[Field]:
    offset = 0
    for name, hint in get_type_hints(record, include_extras=True).items():
        inner = get_args(hint)[0] if get_origin(hint) is ClassVar else hint
        marks = [mark for mark in getattr(inner, "__metadata__", ()) if isinstance(mark, Wire)]
        if not marks:
            continue
        field = Field(name=name, python=get_args(inner)[0], wire=marks[0], offset=offset)
        yield field
        offset += len(field.numbers) * struct.calcsize(_CODES[field.wire.type])


def layout_of(record: type) -> Layout:
    """Layout of a record whose annotations say how its fields stand on the wire.

    Raises
    ------
    TypeError
        If none of them does.
    """
    return _layout_of(record)


@cache
def _layout_of(record: Any) -> Layout:
    fields = tuple(_fields_of(record))
    if not fields:
        raise TypeError(f"{record.__name__}: fields with a `Wire` beside their type wanted")
    numbers = [(name, field) for field in fields for name, _ in field.numbers]
    order = [field.name for _, field in numbers]
    makers = (
        (
            field.name,
            slice(order.index(field.name), order.index(field.name) + len(field.numbers)),
            field.from_wire,
        )
        for field in fields
        if field.is_stored
    )
    return Layout(
        record=record,
        fields=fields,
        rules=getattr(record, "rules", ()),
        form=struct.Struct("<" + "".join(_CODES[field.wire.type] for _, field in numbers)),
        checks=tuple((name, field.allowed, field.range) for name, field in numbers),
        makers=tuple(makers),
    )


def encode(record: object, what: str = "") -> bytes:
    """Bytes of a record; `what` names it in an error.

    That the values fit their widths is all that is checked: a test of a board must be able to
    send what the board has to refuse.

    Raises
    ------
    FrameError
        If a value does not fit its width.
    """
    layout = layout_of(type(record))
    values = [number for field in layout.fields for number in field.to_wire(record)]
    try:
        return layout.form.pack(*values)
    except struct.error as error:
        what = what or type(record).__name__
        raise FrameError(f"{what} does not fit the wire: {error}; got {record}") from error


def decode(record: type[Record], data: bytes, what: str = "") -> Record:
    """Read a record that takes all of `data`; `what` names it in an error.

    Raises
    ------
    FrameError
        If the length is another or a value breaks a rule; the message names all that do.
    """
    layout = layout_of(record)
    if len(data) != layout.size:
        raise FrameError(
            f"{what or record.__name__}: {layout.size} bytes wanted, {len(data)} there"
        )
    return _made(record, layout, data, what)


def decode_head(record: type[Record], data: bytes, what: str = "") -> tuple[Record, int]:
    """Read a record at the head of `data`; with it its length in bytes.

    Raises
    ------
    FrameError
        If `data` is shorter or a value breaks a rule.
    """
    layout = layout_of(record)
    if len(data) < layout.size:
        raise FrameError(
            f"{what or record.__name__}: at least {layout.size} bytes wanted, {len(data)} there"
        )
    return _made(record, layout, data, what), layout.size


def _made(record: type[Record], layout: Layout, data: bytes, what: str) -> Record:
    values = layout.form.unpack_from(data)
    faults = [
        f"{name} {words} wanted, got {value}"
        for (name, allowed, words), value in zip(layout.checks, values, strict=True)
        if value not in allowed
    ]
    if not faults:
        made = record(
            **{
                name: values[place.start] if maker is None else maker(*values[place])
                for name, place, maker in layout.makers
            }
        )
        faults = [f"{rule.words}; got {made}" for rule in layout.rules if not rule.holds(made)]
    if faults:
        raise FrameError(f"{what or record.__name__}: {'; '.join(faults)}")
    return made
