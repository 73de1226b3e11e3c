"""`armodal workspace`: statistics and maps of an arm over its postures, as page and arrays."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.identification.as_effects import identified_arm
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.report import ReportSection
from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.workspace.study import WorkspaceStudy
from armodal.analyzer.workspace.survey import (
    WorkspaceSurvey,
    survey_arrays,
    survey_figures,
    survey_workspace,
)
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.os_words import os_words
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.options import ArmName, Seed
from armodal.tui.command_parts.worker_processes import worker_processes
from armodal.tui.console import Json, out, print_json, print_note, progress, say_next
from armodal.tui.console import progress as told_progress

__all__ = ["app", "workspace_section"]

app = typer.Typer(add_completion=False)


def survey_to_files(
    arm: Arm,
    directory: Path,
    *,
    n_postures: int,
    seed: int,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[dict[str, Any], WorkspaceStudy]:
    """Study an arm and write `workspace.html` and `workspace.npz` into a folder.

    Raises
    ------
    ArmError
        If the arm has no elastic joint, or the folder cannot be written.
    """
    ready = batched(arm)
    page, arrays = directory / "workspace.html", directory / "workspace.npz"
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise ArmError(f"cannot write to {directory}: {os_words(problem)}; check it") from problem
    with _processes(workers) as executor:
        survey = survey_workspace(
            arm,
            ready.elastic,
            n_postures=n_postures,
            seed=seed,
            batch=ready.batch,
            executor=executor,
            progress=progress,
        )
    try:
        page.write_text(_page(arm, survey), encoding="utf-8")
        np.savez_compressed(arrays, **survey_arrays(survey))
    except OSError as problem:
        raise ArmError(f"cannot write to {directory}: {os_words(problem)}; check it") from problem
    study = survey.study
    value = {
        "arm": arm.name,
        "n_postures": study.n_postures,
        "seed": study.seed,
        "mass_mean_kg_m2": study.mass.mean.tolist(),
        "mass_std_kg_m2": study.mass.std.tolist(),
        "f_mean_hz": study.f_hz.mean.tolist(),
        "f_std_hz": study.f_hz.std.tolist(),
        "damping_mean": study.damping_ratio.mean.tolist(),
        "damping_std": study.damping_ratio.std.tolist(),
        "coupling_zeros_deg": []
        if survey.sweep is None
        else np.rad2deg(survey.sweep.zeros_rad).tolist(),
        "freedoms": list(ready.elastic.names(arm)),
        "notes": [*ready.notes, *survey.notes],
        "page": str(page),
        "arrays": str(arrays),
    }
    return value, study


def workspace_section(
    session: Session, result: Identification, n_postures: int, *, session_sha256: str
) -> ReportSection:
    """The workspace with what was identified and what was held beside it, for the report.

    `session_sha256`: of the session file.
    """
    found = identified_arm(
        session.header.arm,
        result,
        source=f"identified from session {session.header.session_id[:8]}",
        session_sha256=session_sha256,
        created=session.header.created,
    )
    ready = batched(found)
    survey = survey_workspace(
        found,
        ready.elastic,
        n_postures=n_postures,
        batch=ready.batch,
        progress=told_progress("postures"),
    )
    return ReportSection(
        title="Workspace, with the identified stiffness and damping",
        notes=(
            *(f"computed with {title}" for title in ready.titles),
            *ready.notes,
            *survey.notes,
        ),
        figures=tuple(survey_figures(found, survey)),
    )


def _processes(workers: int) -> AbstractContextManager[Executor | None]:
    return nullcontext() if workers == 1 else worker_processes(workers)


def workspace_table(study: WorkspaceStudy) -> Table:
    """Frequencies and damping over the postures."""
    table = Table(title=f"{study.arm}: {study.n_postures:,} random postures")
    for column in ("mode", "f Hz", "± std", "lowest", "highest", "damping %", "± std"):
        table.add_column(column, justify="right")
    f, damping = study.f_hz, study.damping_ratio
    for i in range(len(f.mean)):
        table.add_row(
            str(i + 1),
            f"{f.mean[i]:.2f}",
            f"{f.std[i]:.2f}",
            f"{f.lowest[i]:.2f}",
            f"{f.highest[i]:.2f}",
            f"{100 * damping.mean[i]:.2f}",
            f"{100 * damping.std[i]:.2f}",
        )
    return table


def _page(arm: Arm, survey: WorkspaceSurvey) -> str:
    body = "\n".join(
        figure.to_html(full_html=False, include_plotlyjs=number == 0)
        for number, figure in enumerate(survey_figures(arm, survey))
    )
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{shown(arm.name)}: workspace</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">{body}</body></html>\n'
    )


@app.command("workspace")
def workspace_command(
    arm: ArmName,
    postures: Annotated[
        int, typer.Option(min=1, max=100_000_000, help="Number of random postures.")
    ] = 100_000,
    directory: Annotated[Path, typer.Option("--out", help="Folder for page and arrays.")] = Path(
        "workspace"
    ),
    workers: Annotated[int, typer.Option(min=1, max=1024, help="Number of processes.")] = 1,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Mass matrix, frequencies and damping over random postures; maps over the wrist's position.

    Example: armodal workspace viper_s650 --postures 1000000
    """
    value, study = survey_to_files(
        load_arm(arm),
        directory,
        n_postures=postures,
        seed=seed,
        workers=workers,
        progress=progress("postures"),
    )
    if as_json:
        print_json(value)
        return
    out.print(workspace_table(study))
    for note in value["notes"]:
        print_note(note)
    out.print(f"page   {value['page']}\narrays {value['arrays']}")
    say_next(f"plan {arm}", "postures, hits and points that identify its joints")
