"""Registers `armodal review`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from protocols.errors import SessionError

__all__ = ["add_review_command"]


def add_review_command(app: typer.Typer) -> None:
    """Add the command to the command line."""

    @app.command()
    def review(
        session: Annotated[Path, typer.Argument(help="Session file (.h5).")],
        gap: Annotated[
            Path | None, typer.Option(help="Result of `armodal gap --json` to show.")
        ] = None,
    ) -> None:
        """Look at a session: FRFs, poles, modes moving on the arm, stiffness, gap. `?` helps.

        Example: armodal review demo/demo.h5
        """
        # Textual is loaded only by who looks.
        from tui.review.app import ReviewApp  # noqa: PLC0415

        if not session.is_file():
            raise SessionError(f"{session} is not a file; give the .h5 file of a session")
        review_app = ReviewApp(session, gap=gap)
        review_app.run()
        if review_app.problem is not None:
            raise review_app.problem
