"""`armodal identify`: joint stiffness, damping and structural axes of a session."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.penalty_of_session import penalty_of_session
from armodal.protocols.errors import SessionError
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.command_parts.identification_results import (
    identification_json,
    identification_tables,
)
from armodal.tui.command_parts.options import Band, SessionPath
from armodal.tui.command_parts.penalty_results import (
    Method,
    chosen_for,
    penalty_json,
    penalty_tables,
)
from armodal.tui.command_parts.posture_notes import noted_once
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.screens.review.picked_file import read_picked

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command("identify")
def identify_command(
    session: SessionPath,
    method: Annotated[
        Method,
        typer.Option(
            help="frf: whole FRFs; eq13: the penalty method of Bottin et al. (2020) beside it."
        ),
    ] = Method.FRF,
    joints: Annotated[
        str | None, typer.Option(help="Joints for eq13, by name or number, e.g. 1,3; else all.")
    ] = None,
    picked: Annotated[
        Path | None,
        typer.Option(help="Poles picked by hand in `armodal review`: SESSION.picked.json."),
    ] = None,
    band: Band = None,
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
    result = identify(measured, say, picked=poles, band_hz=band)
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
    for note in (*result.notes, *doubts, *noted_once(measured.warnings)):
        print_note(note)
    say_next(f"gap {session}", "asks what the model lacks")
