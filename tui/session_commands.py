"""Commands that need a session: fit, identify, predict, report, gap; and the study of gaps."""

from __future__ import annotations

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from analyzer.gap.workflow import find_gap
from analyzer.identification.identify import identify
from analyzer.identification.penalty_of_session import penalty_of_session
from analyzer.report import gap_page, gap_path, read_gap, write_report
from hil_sim.study import draw_study
from hil_sim.study.catalogue import FIRST
from protocols.arm.files import load_arm
from protocols.errors import SessionError
from protocols.frf_records import FrfEstimator
from protocols.session.hdf5 import read_session
from tui.arm_commands import comma_numbers
from tui.fit import FitSettings, fit_lines, fit_session
from tui.gap import gap_json, gap_tables, keep_gap, replace_text, with_arm
from tui.gap_study import run_study, seal_hashes
from tui.gap_study_summary import study_summary, study_tables
from tui.mozzi import checked_posture
from tui.penalty import Method, chosen_for, penalty_json, penalty_tables
from tui.predict import predict_posture, prediction_json, prediction_tables
from tui.results import identification_json, identification_tables
from tui.review.picked_file import read_picked
from tui.workspace import workspace_section

__all__ = ["app"]

app = typer.Typer()
out = Console(highlight=False)
err = Console(stderr=True, highlight=False)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]
SessionPath = Annotated[Path, typer.Argument(help="Session file (.h5).")]


def _say(text: str) -> None:
    err.print(f"[dim]· {text}[/dim]")


def _print_json(value: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(value, indent=2) + "\n")


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
        _print_json(value)
        return
    out.print(table)
    for line in fit_lines(value):
        out.print(line, markup=False)
    for note in value["warnings"]:
        out.print(f"note: {note}", markup=False)


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
    result = identify(measured, _say, picked=poles)
    beside = None if chosen is None else penalty_of_session(measured, result, chosen)
    if as_json:
        value = identification_json(measured, result)
        _print_json(value if beside is None else value | {"eq13": penalty_json(beside, result)})
        return
    for table in identification_tables(result):
        out.print(table)
    for table in [] if beside is None else penalty_tables(beside, result):
        out.print(table)
    doubts = [f"axis in {axis.link}: {doubt}" for axis in result.axes for doubt in axis.doubts]
    for note in (*result.notes, *doubts, *measured.warnings):
        out.print(f"note: {note}", markup=False)


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
        checked_posture(arm, angles)  # before minutes are spent on the fit
    result = identify(measured, _say)
    found = [predict_posture(arm, result, angles) for angles in asked]
    doubts = [f"axis in {axis.link}: {doubt}" for axis in result.axes for doubt in axis.doubts]
    notes = [*result.notes, *doubts, *measured.warnings]
    if as_json:
        rows = [prediction_json(prediction) for prediction in found]
        _print_json({"arm": arm.name, "postures": rows, "notes": notes})
        return
    for prediction in found:
        for table in prediction_tables(prediction):
            out.print(table)
    for note in notes:
        out.print(f"note: {note}", markup=False)


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
    measured = read_session(session)
    path = output or session.with_suffix(".html")
    result = identify(measured, _say)
    sections = []
    if workspace:
        _say("workspace")
        sections.append(workspace_section(measured.header.arm, result, workspace))
    beside = gap_path(session)
    gap = read_gap(beside) if beside.exists() else None
    write_report(measured, result, path, sections=sections, gap=gap)
    if as_json:
        _print_json({"report": str(path)})
    else:
        out.print(f"report {path}", markup=False)


@app.command("gap")
def gap_command(
    session: SessionPath,
    arm: Annotated[
        Path | None,
        typer.Option("--arm", help="Arm file to believe instead of the session's own."),
    ] = None,
    arm_out: Annotated[
        Path | None,
        typer.Option("--arm-out", help="New arm file with what was named, never replaced."),
    ] = None,
    html: Annotated[Path | None, typer.Option("--html", help="Page to write.")] = None,
    as_json: Json = False,
) -> None:
    """Find where model and measurement disagree, and name what is missing.

    The result is kept beside the session, where `armodal report` finds it.

    With the new arm file as --arm it begins where it ended: nothing more should be missing.

    Example: armodal gap session.h5 --arm-out arm-with-axis.toml
    """
    measured = read_session(session)
    if arm is not None:
        measured = with_arm(measured, load_arm(arm))
    outcome = find_gap(measured, tell=_say)
    written = keep_gap(measured, session, outcome, arm_out)
    if html is not None:
        replace_text(html, gap_page(outcome.result, session.name))
    if as_json:
        _print_json(gap_json(outcome.result, written))
        return
    out.print(outcome.result.summary, markup=False)
    out.print(f"where: {outcome.result.interface}", markup=False)
    for table in gap_tables(outcome.result):
        out.print(table)
    for effect in outcome.result.effects:
        out.print(f"do now: {effect.remedy}", markup=False)
    for note in outcome.result.notes:
        out.print(f"note: {note}", markup=False)
    for key, path in written.items():
        out.print(f"{key} {path}", markup=False)


@app.command("gap-study")
def gap_study_command(
    directory: Annotated[Path, typer.Option("--out", help="Where the study's file goes.")],
    seed: Annotated[int, typer.Option(help="Of the cases.")] = 1,
    nulls: Annotated[int, typer.Option(min=0, help="Cases with nothing hidden.")] = 30,
    effects: Annotated[int, typer.Option(min=0, help="Cases with one effect.")] = 60,
    pairs: Annotated[int, typer.Option(min=0, help="Cases with two.")] = 12,
    outside: Annotated[int, typer.Option(min=0, help="Cases outside the library.")] = 12,
    workers: Annotated[int, typer.Option(min=1, help="Processes.")] = 2,
    as_json: Json = False,
) -> None:
    """Judge sealed cases and print how often the workflow was right.

    A study that was stopped goes on where it was.

    Example: armodal gap-study --out study --seed 1
    """
    specs = draw_study(
        seed, nulls=nulls, effects=effects, pairs=pairs, outside=outside, library=FIRST
    )
    directory.mkdir(parents=True, exist_ok=True)
    for number, digest in seal_hashes(specs).items():
        _say(f"case {number}: truth sealed as {digest}")
    path = directory / f"study-{seed}.jsonl"

    def tell(line: dict[str, Any]) -> None:
        _say(f"case {line['number']}: {line.get('outcome', line.get('error'))}")

    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as executor:
        lines = run_study(specs, path, executor, tell)
    summary = study_summary(lines)
    if as_json:
        _print_json(summary | {"file": str(path)})
        return
    for table in study_tables(summary):
        out.print(table)
    out.print(f"cases {path}", markup=False)
