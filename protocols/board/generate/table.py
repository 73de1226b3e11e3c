"""The table of messages as the generators read it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from armodal.protocols.board.codec import wire_size
from armodal.protocols.board.layout import Layout, layout_of
from armodal.protocols.board.records import MESSAGES, FrameType, Message

__all__ = ["MADE_BY", "REPLY", "TABLE", "Entry", "Table", "snake"]

MADE_BY = "Made by `python -m armodal.protocols.board.generate`; change records.py instead."
REPLY = 0x80  # added to a command's number


def snake(name: str) -> str:
    """Name of a class as C and the document write it.

    >>> snake("BlockInfo")
    'block_info'
    """
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A message of the table."""

    kind: IntEnum
    message: Message

    @property
    def layout(self) -> Layout | None:
        """Fixed fields; None where it has none."""
        return layout_of(self.message.record) if self.message.record else None

    @property
    def is_command(self) -> bool:
        """Whether the host sends it."""
        return self.kind < REPLY


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Frame types, and what the payload of each is."""

    types: type[IntEnum]
    messages: Mapping[Any, Message]

    def __iter__(self) -> Iterator[Entry]:
        """Messages in the order of their numbers, a reply after its command."""
        order = sorted(self.types, key=lambda kind: (kind & ~REPLY, kind))
        for kind in sorted(order, key=lambda kind: kind >= REPLY and not self.is_reply(kind)):
            yield Entry(kind=kind, message=self.messages[kind])

    def is_reply(self, kind: int) -> bool:
        """Whether a type is the reply to a command."""
        return kind - REPLY in {int(each) for each in self.types}

    def records(self) -> Iterator[tuple[Entry, Layout]]:
        """Messages with fixed fields."""
        for entry in self:
            if entry.layout is not None:
                yield entry, entry.layout

    @property
    def longest_command(self) -> int:
        """Bytes on the wire of the longest command, delimiters included."""
        sizes = [layout.size for entry, layout in self.records() if entry.is_command]
        return wire_size(max(sizes, default=0))

    @property
    def longest_answer(self) -> int:
        """Bytes of the longest record that stands behind code and reason of an answer."""
        return max(layout.size for entry, layout in self.records() if entry.message.is_answer)


TABLE = Table(types=FrameType, messages=MESSAGES)
