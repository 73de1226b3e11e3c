"""What reads and writes the messages in C, on a board and on a host."""

from __future__ import annotations

from collections.abc import Iterator

from armodal.protocols.board.fields import LIMITS
from armodal.protocols.board.generate.c_header import (
    c_name,
    prototype,
    read,
    stored_fields,
    written,
)
from armodal.protocols.board.generate.table import MADE_BY, REPLY, Entry, Table
from armodal.protocols.board.layout import Field, Layout
from armodal.protocols.board.records import Header

__all__ = ["c_board_source", "c_host_source"]


def _writer(layout: Layout) -> str:
    lines = []
    for field in layout.fields:
        is_stored = field.is_stored or layout.record is Header
        for name, offset in field.numbers:
            value = f"m->{name}" if is_stored else f"{field.wire.low}"
            at = f"to + {offset}" if offset else "to"
            match field.wire.type:
                case "u8":
                    lines.append(f"to[{offset}] = {value};")
                case "i32":
                    lines.append(f"(void)ab_put_u32({at}, (uint32_t){value});")
                case width:
                    lines.append(f"(void)ab_put_{width}({at}, {value});")
    return _function(prototype(layout, "write"), lines)


def _got(field: Field, offset: int) -> str:
    at = f"from + {offset}" if offset else "from"
    match field.wire.type:
        case "u8":
            return f"from[{offset}]"
        case "i32":
            return f"(int32_t)ab_get_u32({at})"
        case width:
            return f"ab_get_{width}({at})"


def _reader(layout: Layout, *, is_head: bool) -> str:
    stored = stored_fields(layout)
    lines = [
        f"m->{name} = {_got(field, offset)};" for field in stored for name, offset in field.numbers
    ]
    if layout.record is Header:
        return _function(prototype(layout, "read"), lines)
    size = f"AB_{c_name(layout).upper()}_BYTES"
    lines = [f"if (n {'<' if is_head else '!='} {size})", "    return false;", *lines]
    wanted = [
        condition
        for field in layout.fields
        for name, offset in field.numbers
        for condition in _conditions(
            field, f"m->{name}" if field in stored else _got(field, offset)
        )
    ]
    wanted += [rule.c for rule in layout.rules]
    all_of = " &&\n           ".join(wanted) or "true"
    lines.append(f"return {all_of};")
    return _function(prototype(layout, "read"), lines)


def _conditions(field: Field, value: str) -> Iterator[str]:
    least, most = LIMITS[field.wire.type]
    low, high = field.wire.low, field.wire.high
    if field.wire.role == "choice":
        low, high = 0, len(field.members) - 1
        if [int(member) for member in field.members] != list(range(high + 1)):
            raise ValueError(f"{field.name}: a choice of 0, 1, 2 ... wanted for C")
    suffix = {"u64": "ull", "u32": "u"}.get(field.wire.type, "")
    if low == high:
        yield f"{value} == {low}{suffix}"
        return
    if low != least:
        yield f"{value} != 0" if low == 1 and least == 0 else f"{value} >= {low}{suffix}"
    if high != most:
        yield f"{value} <= {high}{suffix}"


def _function(prototype: str, lines: list[str]) -> str:
    body = "\n".join(f"    {line}" if line else "" for line in lines)
    return f"{prototype}\n{{\n{body}\n}}\n"


def c_board_source(table: Table) -> str:
    """Text of `messages.c`: what a board reads and writes, and the types that there are."""
    parts = (_source(table, on_board=True), _known(table), _bare(table), _answers(table))
    return "\n".join(parts)


def c_host_source(table: Table) -> str:
    """Text of `host_messages.c`: what a host reads and writes."""
    return _source(table, on_board=False) + "\n" + _validity(table)


def _source(table: Table, *, on_board: bool) -> str:
    side = "board" if on_board else "host"
    own = "" if on_board else '#include "armodal_host.h"\n\n'
    heads = {layout.record for entry, layout in table.records() if entry.message.tail}
    writers = [_writer(layout) for layout in written(table, on_board=on_board)]
    readers = [
        _reader(layout, is_head=layout.record in heads) for layout in read(table, on_board=on_board)
    ]
    first = (
        f"/* {MADE_BY} */\n"
        f"/* Fixed fields of the messages as a {side} reads and writes them. */\n"
        f'{own}#include "internal.h"\n'
    )
    return "\n".join([first, *writers, *readers])


def _known(table: Table) -> str:
    cases = [f"case {_type_name(table, entry)}:" for entry in table]
    lines = ["switch (type) {", *cases, "    return true;", "default:", "    return false;", "}"]
    return _function("bool ab_type_known(unsigned type)", lines)


def _bare(table: Table) -> str:
    bare = [e for e in table if e.is_command and e.layout is None and not e.message.tail]
    cases = [f"case {_type_name(table, entry)}:" for entry in bare]
    lines = ["switch (type) {", *cases, "    return true;", "default:", "    return false;", "}"]
    return _function("bool ab_command_is_bare(unsigned type)", lines)


def _answers(table: Table) -> str:
    lines = ["switch (type) {"]
    for entry, layout in table.records():
        if entry.message.is_answer:
            size = f"AB_{c_name(layout).upper()}_BYTES"
            lines += [f"case AB_{table.types(entry.kind - REPLY).name}:", f"    return {size};"]
    lines += ["default:", "    return 0;", "}"]
    return _function("size_t ab_answer_bytes(unsigned type)", lines)


def _validity(table: Table) -> str:
    lines = ["const uint8_t *reason;", "size_t size;", "uint8_t code;", "", "switch (type) {"]
    for entry in table:
        if not entry.message.tail:
            lines += _valid(f"case {_type_name(table, entry)}:", entry)
    lines += ["default:", "    return false;", "}"]
    return _function(
        "bool ab_fixed_payload_valid(unsigned type, const uint8_t *from, size_t n)", lines
    )


def _type_name(table: Table, entry: Entry) -> str:
    if table.is_reply(entry.kind):
        return f"AB_{table.types(entry.kind - REPLY).name} | AB_REPLY"
    return f"AB_{entry.kind.name}"


def _valid(case: str, entry: Entry) -> list[str]:
    if entry.layout is None:
        if entry.message.is_answer:
            return [case, "    return ab_read_reply(from, n, &code, &reason, &size);"]
        return [case, "    return n == 0;"]
    name = c_name(entry.layout)
    before, where = "", "from, n"
    if entry.message.is_answer:
        before, where = "ab_is_answer(from, n) && ", "from + 2, n - 2"
    return [
        f"{case} {{",
        f"    ab_{name} {name};",
        "",
        f"    return {before}ab_read_{name}({where}, &{name});",
        "}",
    ]
