"""The app that screens are shown in: no text from a file steers the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from rich.segment import Segment
from textual.app import App
from textual.color import Color
from textual.filter import LineFilter

from armodal.protocols.printable import printable

__all__ = ["PrintableApp"]

Result = TypeVar("Result")


class _Printable(LineFilter):
    """Shows a sign of one cell for what is not seen: a longer one would move what stands behind."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:  # noqa: ARG002
        """Return the segments of a line, their texts made printable."""
        return [
            segment if segment.control else segment._replace(text=_in_cells(segment.text))
            for segment in segments
        ]


def _in_cells(text: str) -> str:
    if printable(text) == text:
        return text
    return "".join(
        sign if printable(sign) == sign else "\N{REPLACEMENT CHARACTER}" for sign in text
    )


class PrintableApp(App[Result]):
    """An app whose every line is made printable before it goes to the terminal."""

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the app's filters and ours."""
        return [*super().get_line_filters(), _Printable()]
