"""The report of the session in review, made beside the app."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from textual.app import App

from armodal.protocols.errors import ArmodalError
from armodal.tui.screens.review.command_run import CommandRun

__all__ = ["write_report_in_background"]


async def write_report_in_background(
    app: App[Any], session: Path, command: tuple[str, ...]
) -> None:
    """Write the report beside the session; say that it begins, and where it is or why not."""
    app.notify("the report is being written: some ten seconds")
    run = CommandRun(("report", str(session), "--json"), lambda _: None, command)
    try:
        found = await run.result()
    except (ArmodalError, OSError) as error:
        app.notify(str(error), severity="error", timeout=20.0, markup=False)
        return
    name = Path(str(found.get("report"))).name
    app.notify(f"report {name}, beside the session", timeout=20.0, markup=False)
