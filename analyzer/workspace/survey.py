"""Everything a workspace page shows: statistics, coupling, maps, and what cannot be had."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.coupling import CouplingSweep, sweep_coupling
from armodal.analyzer.workspace.figures import coupling_figure, map_figure, mass_figure, mode_figure
from armodal.analyzer.workspace.maps import FrequencyMap, map_frequencies
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.analyzer.workspace.study import WorkspaceStudy, study_workspace
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["WorkspaceSurvey", "survey_arrays", "survey_figures", "survey_workspace"]

SWEPT = 2  # joint 3, whose angle sets the coupling of joints 2 and 3
MAPPED_MODES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceSurvey:
    """Statistics over random postures, and what the arm's kinematics allow beside them."""

    study: WorkspaceStudy
    sweep: CouplingSweep | None  # None with fewer than three joints
    mapped: FrequencyMap | None  # None without a meridian plane
    notes: tuple[str, ...]


def survey_workspace(
    arm: Arm,
    elastic: ElasticJoints,
    *,
    n_postures: int,
    seed: int = 0,
    batch: ArmBatch | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> WorkspaceSurvey:
    """Study an arm over its postures, with the stiffness and damping given.

    `batch` as in `study_workspace`.

    Raises
    ------
    ArmError
        If the number of postures is not positive.
    """
    # Joint 1 turns the arm as a whole: file 002, section 6, leaves it at zero.
    study = study_workspace(
        arm,
        elastic,
        n_postures,
        seed=seed,
        still=(0,),
        batch=batch,
        executor=executor,
        progress=progress,
    )
    notes: list[str] = []
    sweep = mapped = None
    if len(arm.joints) > SWEPT:
        middle = sum(arm.joints[SWEPT].range_rad) / 2
        sweep = sweep_coupling(
            arm,
            (1, 2),
            joint=SWEPT,
            limits_rad=(middle - np.pi, middle + np.pi),
            batch=batch,
        )
    try:
        mapped = map_frequencies(arm, elastic, batch=batch)
        notes += mapped.notes
    except ArmError as problem:
        notes.append(str(problem))
    return WorkspaceSurvey(study=study, sweep=sweep, mapped=mapped, notes=tuple(notes))


def survey_figures(arm: Arm, survey: WorkspaceSurvey) -> list[Any]:
    """Plotly figures of a survey (file 002, Figs. 3, 5, 12 to 16)."""
    figures = [mass_figure(survey.study), mode_figure(survey.study)]
    if survey.sweep is not None:
        figures.append(coupling_figure(arm, survey.sweep, SWEPT))
    if survey.mapped is not None:
        n_modes = min(MAPPED_MODES, survey.mapped.f_hz.shape[-1])
        figures += [map_figure(arm, survey.mapped, i) for i in range(n_modes)]
    return figures


def survey_arrays(survey: WorkspaceSurvey) -> dict[str, Any]:
    """The same numbers as named arrays; angles in radians, lengths in metres."""
    study = survey.study
    arrays: dict[str, Any] = {
        "mass_mean": study.mass.mean,
        "mass_std": study.mass.std,
        "f_mean": study.f_hz.mean,
        "f_std": study.f_hz.std,
        "damping_mean": study.damping_ratio.mean,
        "damping_std": study.damping_ratio.std,
    }
    if survey.sweep is not None:
        arrays |= {
            "sweep_angle": survey.sweep.angle_rad,
            "sweep_to_first": survey.sweep.to_first,
            "sweep_to_second": survey.sweep.to_second,
        }
    if survey.mapped is not None:
        arrays |= {
            "map_horizontal": survey.mapped.horizontal_m,
            "map_vertical": survey.mapped.vertical_m,
            "map_f_hz": survey.mapped.f_hz,
            "map_damping": survey.mapped.damping_ratio,
            "map_joints": survey.mapped.joints_rad,
        }
    return arrays
