"""The app that screens are shown in: no text steers the terminal, and every key is answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from rich.segment import Segment
from textual import events
from textual.app import App
from textual.color import Color
from textual.filter import LineFilter

from armodal.protocols.printable import printable
from armodal.tui.screens.key_answer import key_answer

__all__ = ["PrintableApp"]

Result = TypeVar("Result")
ANSWER_AGAIN_S = 3.0  # a key held down is answered once


class _Printable(LineFilter):
    """Shows a sign of one cell for what is not seen: a longer one would move what stands behind."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:  # noqa: ARG002
        """Return the segments of a line, their texts made printable."""
        return [
            segment
            if segment.control or segment.text.isprintable()  # nearly all are: it is quick
            else segment._replace(text=_in_cells(segment.text))
            for segment in segments
        ]


def _in_cells(text: str) -> str:
    return "".join(
        sign if printable(sign) == sign else "\N{REPLACEMENT CHARACTER}" for sign in text
    )


class PrintableApp(App[Result]):
    """An app whose every line is made printable before it goes to the terminal.

    A key that does nothing is answered by those that do.
    """

    _answered_s = float("-inf")

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the app's filters and ours."""
        return [*super().get_line_filters(), _Printable()]

    def takes_key(self, key: str) -> bool:
        """Whether the app takes a key that is bound to no action."""
        del key
        return False

    def on_key(self, event: events.Key) -> None:
        """Answer a key that does nothing."""
        answer = "" if self.takes_key(event.key) else key_answer(event, self.screen)
        if answer and event.time - self._answered_s > ANSWER_AGAIN_S:
            self._answered_s = event.time
            self.notify(answer, timeout=ANSWER_AGAIN_S, markup=False)
