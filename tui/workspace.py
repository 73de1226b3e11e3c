"""`armodal workspace`: statistics and maps of an arm over its postures, as page and arrays."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from analyzer.workspace.coupling import CouplingSweep, sweep_coupling
from analyzer.workspace.figures import coupling_figure, map_figure, mass_figure, mode_figure
from analyzer.workspace.maps import FrequencyMap, map_frequencies
from analyzer.workspace.spectrum import elastic_joints
from analyzer.workspace.study import WorkspaceStudy, study_workspace
from protocols.arm.records import Arm
from protocols.errors import ArmError

__all__ = ["survey_workspace", "workspace_table"]

SWEPT = 2  # joint 3, whose angle sets the coupling of joints 2 and 3


def survey_workspace(
    arm: Arm,
    directory: Path,
    *,
    n_postures: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[dict[str, Any], WorkspaceStudy]:
    """Study an arm and write `workspace.html` and `workspace.npz` into a folder.

    Raises
    ------
    ArmError
        If the arm has no elastic joint, or the folder cannot be written.
    """
    elastic = elastic_joints(arm)
    # Joint 1 turns the arm as a whole: file 002, section 6, leaves it at zero.
    study = study_workspace(arm, elastic, n_postures, seed=seed, still=(0,), progress=progress)
    notes = list(arm.effects_left_out())
    sweep: CouplingSweep | None = None
    mapped: FrequencyMap | None = None
    if len(arm.joints) > SWEPT:
        middle = sum(arm.joints[SWEPT].range_rad) / 2
        one_turn = (middle - np.pi, middle + np.pi)
        sweep = sweep_coupling(arm, (1, 2), joint=SWEPT, limits_rad=one_turn)
    try:
        mapped = map_frequencies(arm, elastic)
    except ArmError as problem:
        notes.append(str(problem))
    page, arrays = directory / "workspace.html", directory / "workspace.npz"
    try:
        directory.mkdir(parents=True, exist_ok=True)
        page.write_text(_page(arm, study, sweep, mapped), encoding="utf-8")
        np.savez_compressed(arrays, **_arrays(study, sweep, mapped))
    except OSError as problem:
        raise ArmError(f"cannot write to {directory}: {problem.strerror}; check it") from problem
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
        "coupling_zeros_deg": [] if sweep is None else np.rad2deg(sweep.zeros_rad).tolist(),
        "notes": notes,
        "page": str(page),
        "arrays": str(arrays),
    }
    return value, study


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


def _page(
    arm: Arm, study: WorkspaceStudy, sweep: CouplingSweep | None, mapped: FrequencyMap | None
) -> str:
    figures = [mass_figure(study), mode_figure(study)]
    if sweep is not None:
        figures.append(coupling_figure(arm, sweep, SWEPT))
    if mapped is not None:
        figures += [map_figure(arm, mapped, i) for i in range(min(3, mapped.f_hz.shape[-1]))]
    body = "\n".join(
        figure.to_html(full_html=False, include_plotlyjs=number == 0)
        for number, figure in enumerate(figures)
    )
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{arm.name}: workspace</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">{body}</body></html>\n'
    )


def _arrays(
    study: WorkspaceStudy, sweep: CouplingSweep | None, mapped: FrequencyMap | None
) -> dict[str, Any]:
    arrays: dict[str, Any] = {
        "mass_mean": study.mass.mean,
        "mass_std": study.mass.std,
        "f_mean": study.f_hz.mean,
        "f_std": study.f_hz.std,
        "damping_mean": study.damping_ratio.mean,
        "damping_std": study.damping_ratio.std,
    }
    if sweep is not None:
        arrays |= {
            "sweep_angle": sweep.angle_rad,
            "sweep_to_first": sweep.to_first,
            "sweep_to_second": sweep.to_second,
        }
    if mapped is not None:
        arrays |= {
            "map_horizontal": mapped.horizontal_m,
            "map_vertical": mapped.vertical_m,
            "map_f_hz": mapped.f_hz,
            "map_damping": mapped.damping_ratio,
            "map_joints": mapped.joints_rad,
        }
    return arrays
