"""Read and write the length-prefixed fields of payloads, never past their end."""

from __future__ import annotations

import struct
from typing import Any

from armodal.protocols.errors import FrameError

__all__ = ["Reader", "pack", "text_field"]


def pack(layout: struct.Struct, what: str, *values: float) -> bytes:
    """Pack values, or raise `FrameError` naming `what` where one does not fit its width."""
    try:
        return layout.pack(*values)
    except (struct.error, OverflowError) as error:
        raise FrameError(f"{what} does not fit the wire: {error}; got {values}") from error


def text_field(text: str, what: str) -> bytes:
    """Length byte and UTF-8 text."""
    try:
        raw = text.encode()
    except UnicodeEncodeError as error:
        raise FrameError(f"{what} cannot be written as UTF-8: {error}") from error
    if len(raw) > 255:
        raise FrameError(f"{what} takes at most 255 bytes of UTF-8, got {len(raw)}")
    return bytes([len(raw)]) + raw


class Reader:
    """A cursor over bytes that raises `FrameError` instead of reading past their end."""

    def __init__(self, data: bytes, what: str) -> None:
        self._data = data
        self._what = what
        self._at = 0

    def take(self, size: int) -> bytes:
        """Next `size` bytes."""
        if self._at + size > len(self._data):
            raise FrameError(
                f"{self._what}: {self._at + size} bytes wanted, {len(self._data)} there"
            )
        piece = self._data[self._at : self._at + size]
        self._at += size
        return piece

    def unpack(self, layout: struct.Struct) -> tuple[Any, ...]:
        """Next fields as `layout` says."""
        return layout.unpack(self.take(layout.size))

    def text(self) -> str:
        """Next length byte and UTF-8 text."""
        raw = self.take(self.take(1)[0])
        try:
            return raw.decode()
        except UnicodeDecodeError as error:
            raise FrameError(f"{self._what}: text is not UTF-8: {error}") from error

    def rest(self) -> bytes:
        """All bytes that are left."""
        return self.take(len(self._data) - self._at)

    def finish(self) -> None:
        """Raise `FrameError` if bytes are left over."""
        if self._at != len(self._data):
            raise FrameError(
                f"{self._what}: {self._at} bytes wanted, {len(self._data)} there: "
                "the rest has no meaning"
            )
