"""Models for scripts: identification, prediction, the missing effect, test plans, the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from armodal.analyzer.gap import workflow
from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.identification import identify as identification
from armodal.analyzer.identification.predicted_posture import Prediction, predict_posture
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.own_arm.of_arm import checked_bodies
from armodal.analyzer.planning.made import MadePlan, made_plan
from armodal.analyzer.report import write_report
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE, load_equipment
from armodal.protocols.session.records import Session

__all__ = ["find_gap", "identify", "plan", "predict", "report"]


def identify(
    session: Session,
    *,
    picked: Mapping[str, Sequence[complex]] | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Identification:
    """Joint stiffness, damping and structural axes, each with its uncertainty.

    Parameters
    ----------
    session
        With accepted hits or FRFs of at least one posture that is not for validation.
    picked
        By posture, poles in rad/s that take the place of the automatic choice.
    band_hz
        Lines that modes and model are fitted to; all by default.

    Raises
    ------
    EstimateError
        If nothing can be identified.

    References
    ----------
    docs/theory-identification.md.
    """
    return identification.identify(session, picked=picked, band_hz=band_hz)


def predict(
    session: Session, identified: Identification, posture_deg: Sequence[float]
) -> Prediction:
    """Modes in any posture of the arm, no sensor on it, from what a session identified.

    Parameters
    ----------
    session, identified
        A session and its identification.
    posture_deg
        (n_joints,) joint angles in degrees.

    Raises
    ------
    ArmError
        If there is another number of angles, or one is out of its joint's range.
    EstimateError
        If the model does not oscillate there.
    """
    return predict_posture(session.header.arm, identified, list(posture_deg))


def find_gap(session: Session, *, more: Sequence[Session] = ()) -> GapResult:
    """Where model and measurement disagree, which effect is missing, and how sure that is.

    Parameters
    ----------
    session
        At least two postures with known joint angles.
    more
        Further tests of the same arm.

    Raises
    ------
    EstimateError
        If the session cannot carry the judgement.

    References
    ----------
    docs/theory-gap.md.
    """
    return workflow.find_gap(session, more=more).result


def plan(
    arm: Arm,
    *,
    folder: str | Path | None = None,
    name: str = "selective",
    n_tests: int = 6,
    minutes: float | None = None,
    floor_m: float | None = None,
    sensors: str | Path | None = None,
    seed: int = 0,
) -> MadePlan:
    """Free postures, hits and points that tell most about an arm's joints, as `armodal plan` does.

    Parameters
    ----------
    arm
        Its effects count; the room that they take is not known, and not kept free.
    folder
        Where its file lies: only an arm whose URDF names meshes needs it.
    name
        Of the plan, in its `text`, which is a plan file's.
    n_tests
        Wanted in all; from four on the last is for validation.
    minutes
        The plan may take: where all points take longer, fewer are measured.
    floor_m
        Height of the floor in the base frame; else the arm's keep-outs, and without any 0.
    sensors
        File of hammers and accelerometers; else sizes that are sold.

    Raises
    ------
    ArmError
        If an effect lacks a parameter, a mesh is missing, or a point lies off its link.
    EstimateError
        If no posture is free, or no point takes a hit for every joint.
    PlanError
        If no accelerometer fits, or the fewest points take longer than `minutes`.
    """
    if folder is None and "<mesh" in (arm.urdf_text or ""):
        raise ArmError(
            f"arm '{arm.name}': its URDF names meshes; wanted the folder of the arm file, "
            "plan(arm, folder=...), got none"
        )
    return made_plan(
        arm,
        np.random.default_rng(seed),
        name=name,
        bodies=checked_bodies(arm, None if folder is None else Path(folder), Remarks()),
        floor_m=floor_m,
        equipment=CATALOGUE if sensors is None else load_equipment(Path(sensors)),
        n_tests=n_tests,
        minutes=minutes,
    )


def report(
    session: Session, identified: Identification, path: str | Path, *, gap: GapResult | None = None
) -> None:
    """Write one self-contained HTML page; an older one is replaced only when it is complete.

    Raises
    ------
    SessionError
        If the file cannot be written.
    """
    write_report(session, identified, Path(path), gap=gap)
