"""What commands and screens show of text from files."""

from __future__ import annotations

import asyncio
import io

import pytest
from rich.table import Table
from textual.app import ComposeResult
from textual.geometry import Region
from textual.widgets import Static

from armodal.tui.console import _Console
from armodal.tui.screens.printable_app import PrintableApp
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.run.app import RunApp

NASTY = "a\x1b[2J\x9b2J\x9d0;title\x07\u202egnp.exe\ud800"


def shown(thing: object, *, is_terminal: bool = True) -> str:
    stream = io.StringIO()
    console = _Console(
        file=stream, force_terminal=is_terminal, width=200, highlight=False, markup=False,
        color_system=None,
    )  # fmt: skip
    console.print(thing)
    return stream.getvalue()


@pytest.mark.parametrize("is_terminal", [True, False])
def test_text_from_a_file_does_not_steer_the_terminal(is_terminal):
    table = Table("name")
    table.add_row(NASTY)
    for thing in (NASTY, table, [NASTY], {"name": NASTY}):
        text = shown(thing, is_terminal=is_terminal)
        for sign in "\x1b\x9b\x9d\x07\u202e\ud800":
            assert sign not in text
        assert "\\x9b" in text


class _Nasty(PrintableApp):
    def compose(self) -> ComposeResult:
        yield Static(NASTY, markup=False)


def test_text_from_a_file_does_not_steer_the_screen():
    async def lines() -> list[str]:
        app = _Nasty()
        async with app.run_test(size=(80, 10)):
            strips = app.query_one(Static).render_lines(Region(0, 0, 80, 3))
            return [strip.text for strip in strips]

    text = "".join(asyncio.run(lines()))
    assert "gnp.exe" in text
    for sign in "\x1b\x9b\x9d\x07\u202e\ud800":
        assert sign not in text


@pytest.mark.parametrize("app", [ReviewApp, RunApp])
def test_both_apps_show_printable_text(app):
    assert issubclass(app, PrintableApp)
