"""Commands that need a session: fit, identify, predict, report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.penalty_of_session import penalty_of_session
from armodal.analyzer.identification.predicted_posture import predict_posture
from armodal.analyzer.report import gap_path, read_gap, write_report
from armodal.protocols.errors import SessionError
from armodal.protocols.frf_records import FrfEstimator
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.arm_commands import comma_numbers
from armodal.tui.console import Json, out, print_json, say
from armodal.tui.fit import FitSettings, fit_lines, fit_session
from armodal.tui.output_file import check_output
from armodal.tui.penalty import Method, chosen_for, penalty_json, penalty_tables
from armodal.tui.predict import prediction_json, prediction_tables
from armodal.tui.results import identification_json, identification_tables
from armodal.tui.review.picked_file import read_picked
from armodal.tui.workspace import workspace_section

__all__ = ["app"]

app = typer.Typer(add_completion=False)

SessionPath = Annotated[Path, typer.Argument(help="Session file (.h5).")]


@app.command()
def fit(
    session: SessionPath,
    band: Annotated[
        tuple[float, float] | None, typer.Option(help="Only lines from LOW to HIGH Hz.")
    ] = None,
    estimator: Annotated[
        FrfEstimator | None, typer.Option(help="Where noise is taken to be; else as planned.")
    ] = None,
    exponential_end: Annotated[
        float | None, typer.Option(help="Exponential window's value at the record's end; 1: none.")
    ] = None,
    force_window: Annotated[
        float | None, typer.Option(help="Seconds of the force kept from the trigger on.")
    ] = None,
    keep_hits: Annotated[
        int | None, typer.Option(min=1, help="Hits averaged at most at a point.")
    ] = None,
    max_order: Annotated[
        int, typer.Option(min=4, max=300, help="Highest order of the stabilisation.")
    ] = 60,
    as_json: Json = False,
) -> None:
    """Fit modes in every posture of a session.

    Example: armodal fit session.h5 --band 3 400 --estimator hv --json
    """
    settings = FitSettings(
        band_hz=band,
        estimator=estimator,
        exponential_end=exponential_end,
        force_s=force_window,
        keep_hits=keep_hits,
        max_order=max_order,
    )
    value, table = fit_session(read_session(session), settings)
    if as_json:
        print_json(value)
        return
    out.print(table)
    for line in fit_lines(value):
        out.print(line)
    for note in value["warnings"]:
        out.print(f"note: {note}")


@app.command("identify")
def identify_command(
    session: SessionPath,
    method: Annotated[
        Method, typer.Option(help="frf: whole FRFs; eq13: file 002's penalty method beside it.")
    ] = Method.FRF,
    joints: Annotated[
        str | None, typer.Option(help="Joints for eq13, by name or number, e.g. 1,3; else all.")
    ] = None,
    picked: Annotated[
        Path | None,
        typer.Option(help="Poles picked by hand in `armodal review`: SESSION.picked.json."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Identify joint stiffness, damping and structural axes.

    Example: armodal identify session.h5 --method eq13 --joints 1,2,3
    """
    measured = read_session(session)
    chosen = chosen_for(method, joints, measured.header.arm)
    if picked is not None and not picked.exists():
        raise SessionError(f"{picked} is not there; `armodal review` writes it with the key s")
    poles = {} if picked is None else read_picked(picked, measured)
    result = identify(measured, say, picked=poles)
    beside = None if chosen is None else penalty_of_session(measured, result, chosen)
    if as_json:
        value = identification_json(measured, result)
        print_json(value if beside is None else value | {"eq13": penalty_json(beside, result)})
        return
    for table in identification_tables(result):
        out.print(table)
    for table in [] if beside is None else penalty_tables(beside, result):
        out.print(table)
    doubts = [f"axis in {axis.link}: {doubt}" for axis in result.axes for doubt in axis.doubts]
    for note in (*result.notes, *doubts, *measured.warnings):
        out.print(f"note: {note}")


@app.command("predict")
def predict_command(
    session: SessionPath,
    posture: Annotated[
        list[str],
        typer.Option(help="Joint angles in degrees, separated by commas; repeatable."),
    ],
    as_json: Json = False,
) -> None:
    """Frequency, damping and shape in any posture, from what a session identifies.

    Example: armodal predict session.h5 --posture=0,30,30,0,90,0 --json
    """
    asked = [comma_numbers(text, "--posture") for text in posture]
    measured = read_session(session)
    arm = measured.header.arm
    for angles in asked:
        wanted_posture(arm, angles)  # before minutes are spent on the fit
    result = identify(measured, say)
    found = [predict_posture(arm, result, angles) for angles in asked]
    doubts = [f"axis in {axis.link}: {doubt}" for axis in result.axes for doubt in axis.doubts]
    notes = [*result.notes, *doubts, *measured.warnings]
    if as_json:
        rows = [prediction_json(prediction) for prediction in found]
        print_json({"arm": arm.name, "postures": rows, "notes": notes})
        return
    for prediction in found:
        for table in prediction_tables(prediction):
            out.print(table)
    for note in notes:
        out.print(f"note: {note}")


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
