"""`armodal review`, which goes on to the next test where that is wanted."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal.protocols.errors import SessionError
from armodal.tui.commands.options import Band
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.follow_app import FollowApp
from armodal.tui.this_system import check_runs_devices

__all__ = ["app", "review_then_measure"]

NICE = 10  # as a rule for what works beside something that must not wait

app = typer.Typer(add_completion=False)


def _measure(**wanted: Any) -> int:
    """Run the operator's app, which is loaded where it is wanted: not on every system."""
    check_runs_devices("run")
    return int(import_module("armodal.tui.commands.run").run_app(**wanted))


def review_then_measure(review_app: ReviewApp, *, run: Callable[..., int] = _measure) -> int:
    """Run the review app to its end, then the next test if it was left for that.

    Parameters
    ----------
    review_app
        Not yet running.
    run
        Runs the operator's app.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    ArmodalError
        If the session cannot be shown, or the next test cannot be begun.
    """
    review_app.run()
    if review_app.problem is not None:
        raise review_app.problem
    wanted = review_app.next_run
    if wanted is None:
        return review_app.return_code or 0
    return run(
        plan=str(wanted.plan),
        arm=wanted.arm,
        session=wanted.journal,
        simulated=wanted.simulated,
    )


@app.command()
def review(
    session: Annotated[Path, typer.Argument(help="Session file (.h5); with --follow a journal.")],
    gap: Annotated[
        Path | None, typer.Option(help="Result of `armodal gap --json` to show.")
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="Look at a journal while it is measured.")
    ] = False,
    band: Band = None,
) -> None:
    """Look at a session: FRFs, poles, modes moving on the arm, stiffness, gap. `?` helps.

    With --follow the session's journal is read, again and again while it is written: what was
    accepted is shown within seconds. Nothing is written, and who measures is not disturbed.

    Example: armodal review demo/demo.h5
    """
    if follow:
        raise typer.Exit(_follow(session, gap))
    if not session.is_file():
        raise SessionError(f"{session} is not a file; give the .h5 file of a session")
    raise typer.Exit(review_then_measure(ReviewApp(session, gap=gap, band_hz=band)))


def _follow(session: Path, gap: Path | None) -> int:
    journal = session.with_suffix(".journal")
    if not journal.is_file():
        raise SessionError(
            f"{journal} is not there; give the journal that `armodal run` or `armodal acquire` "
            "writes"
        )
    if sys.platform != "win32":
        os.nice(NICE)  # fits wait where acquisition wants the processor
    return review_then_measure(FollowApp(journal, gap=gap))
