"""`armodal review`, which goes on to the next test where that is wanted."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from armodal.protocols.errors import SessionError
from armodal.tui.command_parts.journey import go_from, wish_after_review
from armodal.tui.command_parts.options import Band
from armodal.tui.console import check_terminal
from armodal.tui.screens.review.follow_app import FollowApp
from armodal.tui.screens.wishes import Look

__all__ = ["app"]

NICE = 10  # as a rule for what works beside something that must not wait

app = typer.Typer(add_completion=False)


@app.command()
def review(
    session: Annotated[Path, typer.Argument(help="Session file (.h5); with --follow a journal.")],
    gap: Annotated[
        Path | None, typer.Option(help="Result of `armodal gap --json` to show.")
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="Follow a journal while it is being measured.")
    ] = False,
    band: Band = None,
) -> None:
    """Look at a session: FRFs, poles, modes moving on the arm, stiffness, gap. `?` helps.

    With --follow the journal is read while it is being written: accepted hits are shown within
    seconds. Nothing is written, and the measurement is not disturbed.

    Example: armodal review demo/demo.h5
    """
    if follow:
        if band is not None:
            raise SessionError(
                "wanted --band with a session file only, got --follow; leave one out"
            )
        raise typer.Exit(_follow(session, gap))
    if not session.is_file():
        raise SessionError(f"{session} is not a file; give the .h5 file of a session")
    check_terminal("review")
    raise typer.Exit(go_from(Look(session=session, gap=gap, band_hz=band)))


def _follow(session: Path, gap: Path | None) -> int:
    journal = session.with_suffix(".journal")
    if not journal.is_file():
        raise SessionError(
            f"{journal} is not there; give the journal that `armodal run` or `armodal acquire` "
            "writes"
        )
    check_terminal("review")
    if sys.platform != "win32":
        os.nice(NICE)  # fits wait where acquisition wants the processor
    app = FollowApp(journal, gap=gap)
    app.run()
    code, then = wish_after_review(app)
    return code if then is None else go_from(then)
