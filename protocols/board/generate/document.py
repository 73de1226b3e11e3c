"""The tables of `docs/board-protocol.md`, each between two markers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from armodal.protocols.board.generate.table import Entry, Table
from armodal.protocols.board.layout import Layout, layout_of
from armodal.protocols.board.records import Header

__all__ = ["document_with_tables", "tables"]

_REPLY_HEAD_BYTES = 2  # code, and length of the reason, which is 0 in front of a record
_MARKED = re.compile(
    r"<!-- ([\w ]+): made from the table of messages -->\n.*?<!-- end -->\n", re.DOTALL
)


def document_with_tables(document: str, table: Table) -> str:
    """The document with what stands between its markers made anew.

    A message without markers gets them at the end of its section, under a heading of its name and
    the first line of its record's docstring.

    Raises
    ------
    ValueError
        If a marker names nothing, or something of the table has neither marker nor section.
    """
    wanted = dict(tables(table))
    for entry, _ in table.records():
        if entry.kind.name not in _MARKED.findall(document):
            document = _with_markers(document, entry)
    found = _MARKED.findall(document)
    if sorted(found) != sorted(wanted):
        raise ValueError(
            f"the document must have a pair of markers for each of {sorted(wanted)}, and has them "
            f"for {sorted(found)}"
        )
    return _MARKED.sub(lambda match: marked(match[1], wanted), document)


def _with_markers(document: str, entry: Entry) -> str:
    """The document with a place for a message's table at the end of its section, if it has one."""
    section = re.search(
        rf"^## {entry.message.section}\. .*?(?=^## |\Z)", document, re.MULTILINE | re.DOTALL
    )
    if section is None or entry.message.record is None:
        return document
    words = (entry.message.record.__doc__ or "").split("\n", maxsplit=1)[0]
    place = f"### {entry.kind.name}\n\n{words}\n\n{marked(entry.kind.name, {entry.kind.name: ''})}"
    end = section.end()
    return f"{document[:end].rstrip()}\n\n{place}\n{document[end:]}"


def marked(name: str, texts: Mapping[str, str]) -> str:
    """A text between its markers."""
    return f"<!-- {name}: made from the table of messages -->\n\n{texts[name]}\n<!-- end -->\n"


def tables(table: Table) -> Iterator[tuple[str, str]]:
    """Name and Markdown of each part of the document that is made."""
    yield "longest command", _longest(table)
    yield "header", _fields(layout_of(Header))
    yield "messages", _messages(table)
    for entry, layout in table.records():
        at = _REPLY_HEAD_BYTES if entry.message.is_answer else 0
        yield entry.kind.name, _fields(layout, at, entry.message.tail)


def _longest(table: Table) -> str:
    return (
        f"The longest command is {table.longest_command} bytes on the wire, delimiters included, "
        "so a board needs no larger\nreceive buffer. What is longer, an unknown command or a "
        "CONFIGURE with bytes too many, it may pass over\nwithout an answer; if it answers, then "
        "as section 4 says.\n"
    )


def _rows(columns: list[str], rows: list[list[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join(
        f"|{'|'.join(f' {cell} ' if cell != '---' else cell for cell in line)}|\n" for line in lines
    )


def _messages(table: Table) -> str:
    rows = [
        [
            f"`{int(entry.kind):02x}`",
            entry.kind.name,
            "host" if entry.is_command else "board",
            _payload(entry),
        ]
        for entry in table
    ]
    return _rows(["type", "name", "from", "payload"], rows)


def _payload(entry: Entry) -> str:
    parts = ["reply"] if entry.message.is_answer else []
    if entry.layout is not None:
        parts.append(f"{entry.layout.size} bytes")
    if entry.message.tail:
        parts.append(entry.message.tail)
    where = f", section {entry.message.section}" if entry.layout is not None else ""
    return ", then ".join(parts or ["none"]) + where


def _fields(layout: Layout, at: int = 0, tail: str = "") -> str:
    has_units = any(field.wire.unit for field in layout.fields)
    rows = []
    for field in layout.fields:
        words = "; ".join(filter(None, (field.wire.words, field.range)))
        for name, offset in field.numbers:
            unit = [field.wire.unit] if has_units else []
            rows.append([str(at + offset), field.wire.type, name, *unit, words])
    if tail:
        rows.append([str(at + layout.size), "rest", tail, *([""] if has_units else []), ""])
    columns = ["offset", "size", "field", *(["unit"] if has_units else []), "meaning"]
    rules = "".join(f"\n`{rule.words}`\n" for rule in layout.rules)
    return _rows(columns, rows) + rules.replace("`", "")
