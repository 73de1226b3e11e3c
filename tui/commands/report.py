"""`armodal report`: one page of a session."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.report import gap_path, read_gap, write_report
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.commands.options import SessionPath
from armodal.tui.commands.workspace import workspace_section
from armodal.tui.console import Json, out, print_json, say
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def report(
    session: SessionPath,
    output: Annotated[Path | None, typer.Option("--out", help="HTML file to write.")] = None,
    workspace: Annotated[
        int,
        typer.Option(
            min=0,
            max=100_000_000,
            help="Also the workspace with what was identified, over so many random postures.",
        ),
    ] = 0,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page of a session.

    Example: armodal report session.h5 --workspace 100000 --out report.html
    """
    path = output or session.with_suffix(".html")
    beside = gap_path(session)
    check_output(path, session, beside)
    measured = read_session(session)
    gap = read_gap(beside) if beside.exists() else None
    result = identify(measured, say)
    sections = []
    if workspace:
        say("workspace")
        sections.append(workspace_section(measured.header.arm, result, workspace))
    write_report(measured, result, path, sections=sections, gap=gap)
    if as_json:
        print_json({"report": str(path)})
    else:
        out.print(f"report {path}")
