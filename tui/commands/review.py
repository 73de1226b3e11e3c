"""`armodal review`, which goes on to the next test where that is wanted."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal.protocols.errors import SessionError
from armodal.tui.commands.options import Band
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.this_system import check_runs_devices

__all__ = ["app", "review_then_measure"]

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
    session: Annotated[Path, typer.Argument(help="Session file (.h5).")],
    gap: Annotated[
        Path | None, typer.Option(help="Result of `armodal gap --json` to show.")
    ] = None,
    band: Band = None,
) -> None:
    """Look at a session: FRFs, poles, modes moving on the arm, stiffness, gap. `?` helps.

    Example: armodal review demo/demo.h5
    """
    if not session.is_file():
        raise SessionError(f"{session} is not a file; give the .h5 file of a session")
    raise typer.Exit(review_then_measure(ReviewApp(session, gap=gap, band_hz=band)))
