"""Where commands speak: data to stdout, the rest to stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console, ConsoleOptions, RenderableType
from rich.markup import escape
from rich.segment import Segment
from rich.table import Table

from armodal.daq.clock import check_time_scale
from armodal.protocols.errors import SessionError
from armodal.protocols.printable import printable
from armodal.tui.fitting_table import FittingTable
from armodal.tui.json_text import json_text

__all__ = [
    "Json",
    "TimeScale",
    "check_terminal",
    "err",
    "out",
    "print_json",
    "print_note",
    "progress",
    "say",
    "say_next",
    "working",
]


class _Console(Console):
    """Text as it is: brackets in a name are no markup, and a pipe's lines are not folded."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterator[Segment]:
        """Render anything, text from files made printable: colours are the console's alone."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))

    def print(self, *objects: Any, **settings: Any) -> None:
        """Print objects; tables as they fit, text folded only on a terminal."""
        is_text = all(isinstance(thing, (str, Path)) for thing in objects)
        settings.setdefault("soft_wrap", is_text and not self.is_terminal)
        fitting = (FittingTable(one) if isinstance(one, Table) else one for one in objects)
        super().print(*fitting, **settings)


out = _Console(highlight=False, markup=False)
err = _Console(stderr=True, highlight=False, markup=False)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def _checked(scale: float) -> float:
    check_time_scale(scale)
    return scale


TimeScale = Annotated[float, typer.Option(callback=_checked, help="Simulated seconds per second.")]


def say(text: str) -> None:
    """Tell what is being done."""
    err.print(f"· {text}", style="dim")


def print_note(text: str) -> None:
    """Print what a person must know beside the numbers: one line, whatever a file says."""
    out.print(f"note: {printable(text, keep='')}")


def say_next(command: str, why: str = "") -> None:
    """Say which command comes next, as the last line; it is no data."""
    err.print(f"next: armodal {command}{f'   {why}' if why else ''}")


def check_terminal(name: str) -> None:
    """Refuse an app that has no terminal to draw on.

    Raises
    ------
    SessionError
        If input or output is no terminal.
    """
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise SessionError(
            f"armodal {name} is an app on a whole screen: wanted a terminal for its input and "
            "output, got a pipe or a file; run it in a terminal, or use the commands that print "
            "(armodal --help)"
        )


@contextmanager
def working(what: str) -> Iterator[Callable[[str], None]]:
    """One line on stderr that says what is being done now, while it is done; on a terminal only."""
    if not err.is_terminal:
        yield lambda _doing: None
        return
    try:
        with err.status(escape(what)) as line:
            yield lambda doing: line.update(escape(f"{what}: {doing} (Ctrl-C stops)"))
    except KeyboardInterrupt:
        err.print("armodal: stopped")
        raise


def progress(what: str) -> Callable[[int, int], None]:
    """Return what tells each tenth of a long work, called with what is done and what is wanted."""
    shown = -1

    def show(done: int, wanted: int) -> None:
        nonlocal shown
        tenth = 10 * done // wanted
        if tenth != shown:
            shown = tenth
            say(f"{what} {100 * done // wanted} %")

    return show


def print_json(value: object) -> None:
    """Print one JSON object; null where a number is not known or not finite."""
    sys.stdout.write(json_text(value))
