"""The C header of the messages: types, records, and prototypes of what reads and writes them."""

from __future__ import annotations

from collections.abc import Iterator
from enum import IntEnum, IntFlag

from armodal.protocols.board.generate.table import MADE_BY, REPLY, Table, snake
from armodal.protocols.board.layout import Field, Layout, layout_of
from armodal.protocols.board.records import BoardState, Header, Overflow, ReplyCode, Slope

__all__ = ["c_header", "c_name", "prototype", "read", "stored_fields", "written"]

_C_TYPES = {"u8": "uint8_t", "u16": "uint16_t", "u32": "uint32_t", "u64": "uint64_t"}
_C_TYPES |= {"i32": "int32_t"}
# Name of the C type and what stands before its members; other enumerations are named whole.
_ENUMS = {
    ReplyCode: ("ab_code", "AB_"),
    BoardState: ("ab_state", "AB_"),
    Slope: ("ab_slope", "AB_"),
    Overflow: ("ab_overflow", "AB_OVERFLOW_"),
}


def c_name(layout: Layout) -> str:
    """Name of a record in C, without `ab_`."""
    return snake(layout.record.__name__)


def stored_fields(layout: Layout) -> list[Field]:
    """Fields of the C record: of the header all, as a version that is another must be seen."""
    return [f for f in layout.fields if f.is_stored or layout.record is Header]


def c_header(table: Table) -> str:
    """Text of `armodal_messages.h`."""
    parts = [
        f"/* {MADE_BY} */",
        "/* Messages of the board protocol: types, fixed fields, their readers and writers. */",
        "#ifndef ARMODAL_MESSAGES_H\n#define ARMODAL_MESSAGES_H\n",
        "#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n",
        "typedef enum {\n" + "\n".join(_type_lines(table)) + "\n} ab_type;\n",
        *(_enum(kind) for kind in _enumerations(table)),
        "enum {\n" + ",\n".join(_size_lines(table)) + "\n};\n",
        *(_struct(title, layout) for title, layout in _titled(table)),
        "/* For a board: messages.c. False where the payload is malformed. */",
        *(prototype(layout, "write") + ";" for layout in written(table, on_board=True)),
        *(prototype(layout, "read") + ";" for layout in read(table, on_board=True)),
        "/* Whether the table of messages has a type. */",
        "bool ab_type_known(unsigned type);",
        "/* Whether a command of the table carries nothing. */",
        "bool ab_command_is_bare(unsigned type);",
        "/* Bytes of the record behind code and reason of a command's answer; 0 without one. */",
        "size_t ab_answer_bytes(unsigned type);",
        "\n/* For a host: host_messages.c. */",
        *(prototype(layout, "write") + ";" for layout in written(table, on_board=False)),
        *(prototype(layout, "read") + ";" for layout in read(table, on_board=False)),
        "/* The same by type, where nothing of varying length follows but a reply's reason. */",
        "bool ab_fixed_payload_valid(unsigned type, const uint8_t *from, size_t n);",
        "\n#endif\n",
    ]
    return "\n".join(parts)


def _type_lines(table: Table) -> Iterator[str]:
    kinds = [entry.kind for entry in table if not table.is_reply(entry.kind)]
    rows = [(int(kind), f"    AB_{kind.name} = 0x{kind:02x}") for kind in kinds]
    rows.append((REPLY, f"    AB_REPLY = 0x{REPLY:02x} /* added to a command's type */"))
    lines = [line for _, line in sorted(rows)]
    for line in lines[:-1]:
        yield line.replace(" /*", ", /*") if "/*" in line else f"{line},"
    yield lines[-1]


def _enumerations(table: Table) -> Iterator[type[IntEnum | IntFlag]]:
    yield ReplyCode
    yield Overflow
    seen: set[type] = set()
    for _, layout in table.records():
        for field in layout.fields:
            if field.wire.role == "choice" and field.python not in seen:
                seen.add(field.python)
                yield field.python


def _enum(kind: type[IntEnum | IntFlag]) -> str:
    whole = snake(kind.__name__)
    name, prefix = _ENUMS.get(kind, (f"ab_{whole}", f"AB_{whole.upper()}_"))
    rows = ",\n".join(f"    {prefix}{member.name} = {int(member)}" for member in kind)
    return f"typedef enum {{\n{rows}\n}} {name};\n"


def _size_lines(table: Table) -> Iterator[str]:
    # The longest command between its delimiters, and the longest record of an answer.
    yield f"    AB_RECEIVE_BYTES = {table.longest_command - 2}"
    yield f"    AB_ANSWER_BYTES = {table.longest_answer}"
    for _, layout in _titled(table):
        yield f"    AB_{c_name(layout).upper()}_BYTES = {layout.size}"


def _titled(table: Table) -> Iterator[tuple[str, Layout]]:
    """Each record once, with the words above it."""
    yield "The header of every frame, section 3.", layout_of(Header)
    seen: set[type] = set()
    for entry, layout in table.records():
        if layout.record not in seen:
            seen.add(layout.record)
            head = ": what stands before its " + entry.message.tail if entry.message.tail else ""
            yield f"{entry.kind.name}{head}, section {entry.message.section}.", layout


def _struct(title: str, layout: Layout) -> str:
    lines = []
    for field in stored_fields(layout):
        unit = f" ({field.wire.unit})" if field.wire.unit else ""
        words = "; ".join(filter(None, (field.wire.words + unit, field.range)))
        for name, _ in field.numbers:
            declared = f"    {_C_TYPES[field.wire.type]} {name};"
            comment = f" /* {words} */"
            if len(declared + comment) > 100:
                lines.append(f"   {comment}")
                comment = ""
            lines.append(declared + comment)
            words = "over it" if field.wire.role == "rational" else words
    body = "\n".join(lines)
    return f"/* {title} */\ntypedef struct {{\n{body}\n}} ab_{c_name(layout)};\n"


def _sided(table: Table, *, commands: bool) -> Iterator[Layout]:
    seen: set[type] = set()
    for entry, layout in table.records():
        if entry.is_command == commands and layout.record not in seen:
            seen.add(layout.record)
            yield layout


def written(table: Table, *, on_board: bool) -> Iterator[Layout]:
    """Records that one side writes, the header with those of the board."""
    if on_board:
        yield layout_of(Header)
    yield from _sided(table, commands=not on_board)


def read(table: Table, *, on_board: bool) -> Iterator[Layout]:
    """Records that one side reads, the header with those of the board."""
    if on_board:
        yield layout_of(Header)
    yield from _sided(table, commands=on_board)


def prototype(layout: Layout, verb: str) -> str:
    """What a record is written or read by; `verb` is `write` or `read`."""
    name = c_name(layout)
    size = f"AB_{name.upper()}_BYTES"
    if verb == "write":
        return f"void ab_write_{name}(uint8_t to[{size}], const ab_{name} *m)"
    if layout.record is Header:
        return f"void ab_read_{name}(const uint8_t from[{size}], ab_{name} *m)"
    return f"bool ab_read_{name}(const uint8_t *from, size_t n, ab_{name} *m)"
