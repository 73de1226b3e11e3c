"""Test vectors of every field's extremes, from the table alone."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields
from enum import IntFlag
from fractions import Fraction
from itertools import product
from typing import Any

from armodal.protocols.board.fields import LIMITS
from armodal.protocols.board.generate.table import MADE_BY, Table
from armodal.protocols.board.layout import Field, Layout, encode, layout_of
from armodal.protocols.board.records import PROTOCOL_VERSION, Header

__all__ = ["field_vectors", "valid_record"]


def _extremes(field: Field) -> list[Any]:
    """Values of a field worth a vector: the ends of its range, or all it may be."""
    low, high = field.wire.low, field.wire.high
    if field.members:
        return list(field.members)
    match field.wire.role:
        case "flag":
            return [False, True]
        case "rational":
            return [Fraction(low), Fraction(high), Fraction(low, high)]
        case "flags":
            every = list(field.python) if issubclass(field.python, IntFlag) else []
            return [field.python(0), *every, field.python(sum(every))]
        case _:
            return [low, high]


def _records(layout: Layout) -> Iterator[tuple[str, object, str]]:
    """Name, record, and the rule it breaks, if any, for each extreme of each field."""
    stored = [field for field in layout.fields if field.is_stored]
    ends = {field.name: [_extremes(field)[0], _extremes(field)[-1]] for field in stored}
    for field in stored:
        for value in _extremes(field):
            tried = [
                layout.record(**(dict(zip(ends, values, strict=True)) | {field.name: value}))
                for values in (product(*ends.values()) if layout.rules else _corners(ends))
            ]
            kept = (m for m in tried if all(rule.holds(m) for rule in layout.rules))
            made = next(kept, tried[0])
            broken = next((rule.words for rule in layout.rules if not rule.holds(made)), "")
            shown = value.name if hasattr(value, "name") else value
            yield f"{field.name} {shown}", made, broken


def _corners(ends: dict[str, list[Any]]) -> list[list[Any]]:
    return [[pair[0] for pair in ends.values()]]


def _outside(layout: Layout) -> Iterator[tuple[str, bytes]]:
    """Bytes that are no record because a number is outside its range."""
    data = encode(valid_record(layout))
    for field in layout.fields:
        low, high = field.wire.low, field.wire.high
        if field.wire.role == "choice":
            high = max(int(member) for member in field.members)
        least, most = LIMITS[field.wire.type]
        for name, offset in field.numbers:
            size = (most - least).bit_length() // 8
            for value in (each for each in (low - 1, high + 1) if least <= each <= most):
                number = value.to_bytes(size, "little", signed=least < 0)
                yield f"{name} {value}", data[:offset] + number + data[offset + size :]


def _plain(value: Any, wide: bool) -> Any:
    if isinstance(value, Fraction):
        return [value.numerator, value.denominator]
    return str(value) if wide else value if isinstance(value, bool) else int(value)


def _fields(record: object, layout: Layout) -> dict[str, Any]:
    wide = {field.name for field in layout.fields if field.wire.type == "u64"}
    return {
        field.name: _plain(getattr(record, field.name), field.name in wide)
        for field in fields(record)  # type: ignore[arg-type]  # a dataclass by its layout
    }


def valid_record(layout: Layout) -> object:
    """A record of a layout that keeps its rules: the first of its extremes that does."""
    return next(record for _, record, broken in _records(layout) if not broken)


def field_vectors(table: Table) -> str:
    """JSON of records and of bytes that are none, one a line."""
    valid, invalid = [], []
    layouts = [("header", layout_of(Header), "")]
    layouts += [(entry.kind.name, layout, entry.message.tail) for entry, layout in table.records()]
    for message, layout, tail in layouts:
        for name, record, broken in _records(layout):
            row = {"name": f"{message}: {name}", "record": message, "bytes": encode(record).hex()}
            if broken:
                invalid.append(row | {"reason": broken})
            else:
                valid.append(row | {"fields": _fields(record, layout)})
        if message == "header":
            continue  # whose version and type have their own refusals, `invalid_frames`
        whole = encode(valid_record(layout))
        cases = [*_outside(layout), ("one byte short", whole[:-1])]
        if not tail:
            cases.append(("one byte too long", whole + b"\0"))
        invalid += [
            {"name": f"{message}: {name}", "record": message, "bytes": data.hex(), "reason": name}
            for name, data in cases
        ]
    parts = [
        f' "made": {json.dumps(MADE_BY)}',
        f' "version": {PROTOCOL_VERSION}',
        *(
            f' "{key}": [\n' + ",\n".join(f"  {json.dumps(row)}" for row in rows) + "\n ]"
            for key, rows in (("records", valid), ("invalid_records", invalid))
        ),
    ]
    return "{\n" + ",\n".join(parts) + "\n}\n"
