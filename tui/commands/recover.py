"""`armodal recover`: the session file of a journal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal import SOFTWARE
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.protocols.session.recovery import rebuild
from armodal.tui.console import Json, out, print_json

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def recover(
    journal: Annotated[Path, typer.Argument(help="Journal of an interrupted session.")],
    output: Annotated[Path | None, typer.Option("--out", help="Session file to write.")] = None,
    as_json: Json = False,
) -> None:
    """Rebuild the session file from a journal, and say what was recovered and dropped.

    Example: armodal recover session.journal
    """
    path = output or journal.with_suffix(".h5")
    found = rebuild(
        journal,
        path,
        software=SOFTWARE,
        estimate_frfs=lambda session: estimate_frfs(session, Superset(session.header.arm)),
    )
    summary = {
        "session": str(path),
        "hits": {"accepted": found.accepted, "rejected": found.rejected},
        "recovered_bytes": found.recovered_bytes,
        "dropped_bytes": found.dropped_bytes,
        "complete": found.session.complete,
        "warnings": list(found.session.warnings),
        "frf_problem": found.frf_problem,
    }
    if as_json:
        print_json(summary)
        return
    for name, value in summary.items():
        out.print(f"{name:<16}{value}")
