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
from armodal.analyzer.planning.selective import SelectivePlan, plan_tests
from armodal.analyzer.report import write_report
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.protocols.arm.records import Arm
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


def plan(arm: Arm, *, n_tests: int = 6, seed: int = 0) -> SelectivePlan:
    """Postures, hits and points that tell most about an arm's joints.

    Raises
    ------
    EstimateError
        If no posture is clear of floor and base, or no point takes a hit for every joint.
    """
    rng = np.random.default_rng(seed)
    return plan_tests(arm, elastic_joints(arm), rng, n_tests=n_tests)


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
