"""`armodal report`: one page of a session."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Annotated

import typer

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import check_session
from armodal.analyzer.gap.gates import gates_of
from armodal.analyzer.gap.records import Gate
from armodal.analyzer.identification.identify import estimate_frfs, identify
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.modal import fit_modes, proposed_band
from armodal.analyzer.report import (
    PlotlyHome,
    gap_path,
    read_gap,
    write_plain_report,
    write_report,
)
from armodal.protocols.errors import ArmError, EstimateError
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.options import Band, SessionPath
from armodal.tui.commands.workspace import workspace_section
from armodal.tui.console import Json, out, print_json, say, say_next
from armodal.tui.output_file import check_output
from armodal.tui.pdf import check_prints, print_pdf

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
            help="Also a workspace study with the identified values, over so many random postures.",
        ),
    ] = 0,
    band: Band = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="Also write a PDF beside it.")] = False,
    plotly: Annotated[
        PlotlyHome,
        typer.Option(
            help="The figures' library: in the page, or in one file shared by many pages."
        ),
    ] = PlotlyHome.EMBEDDED,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page of a session: of an arm, or of a plain structure.

    Example: armodal report session.h5 --workspace 100000 --out report.html
    """
    path = output or session.with_suffix(".html")
    beside = gap_path(session)
    check_output(path, session, beside)
    printed = path.with_suffix(".pdf")
    if pdf:
        check_output(printed, session, beside)
        check_prints()
    measured = read_session(session)
    if not measured.header.arm.joints:
        if workspace:
            raise ArmError(
                "--workspace: wanted an arm with joints, the session is of a plain structure; "
                "leave it out"
            )
        _plain(measured, band, path, plotly)
    else:
        gap = read_gap(beside) if beside.exists() else None
        result = identify(measured, say, band_hz=band)
        sections = []
        if workspace:
            say("workspace")
            digest = sha256(session.read_bytes()).hexdigest()
            sections.append(workspace_section(measured, result, workspace, session_sha256=digest))
        write_report(
            measured,
            result,
            path,
            sections=sections,
            gap=gap,
            gates=() if gap is not None else _checks(measured, result),
            plotly=plotly,
        )
    if pdf:
        say("PDF")
        print_pdf(path, printed)
    if as_json:
        print_json({"report": str(path), "pdf": str(printed) if pdf else None})
        return
    out.print(f"report {path}")
    if pdf:
        out.print(f"pdf    {printed}")
    if measured.header.arm.joints and not beside.exists():
        say_next(f"gap {session}", "asks what the model lacks; then report again")
    else:
        say_next(f"review {session}")


def _checks(session: Session, result: Identification) -> tuple[Gate, ...]:
    say("checks without a model")
    superset = Superset(session.header.arm)
    return gates_of(check_session(session, result.frfs, superset, result.modal_models))


def _plain(
    session: Session, band_hz: tuple[float, float] | None, path: Path, plotly: PlotlyHome
) -> None:
    """Fit the modes of every posture and write the report of a structure without joints."""
    frfs = estimate_frfs(session, Superset(session.header.arm), band_hz=band_hz)
    if not frfs:
        raise EstimateError(
            "the session has no accepted hits and no FRFs: there is nothing to report; measure "
            "first"
        )
    models = []
    said: list[str] = []
    for frf in frfs:
        say(f"modes of {frf.posture}")
        band = band_hz
        if band is None:
            band, notes = proposed_band(frf)
            said += notes
        models.append(fit_modes(frf, band_hz=band))
    session = replace(session, warnings=(*session.warnings, *said))
    write_plain_report(session, frfs, models, path, band_hz=band_hz, plotly=plotly)
