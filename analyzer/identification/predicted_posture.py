"""The modes that an identified session predicts in any posture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.identification.prediction import (
    ModelScatter,
    PredictedModes,
    predict_modes,
    prediction_model_std,
)
from armodal.analyzer.identification.records import Identification
from armodal.protocols.arm.records import Arm

__all__ = ["Prediction", "predict_posture"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Modes of one posture, no sensor on the arm, with both kinds of uncertainty.

    Attributes
    ----------
    arm : Arm
        That was predicted.
    posture_deg : tuple of float
        Joint angles, degrees.
    freedoms : tuple of str
        Joints, then structural axes, then what effects let give way.
    predicted : PredictedModes
        Modes (Hz, damping ratio, shapes over `freedoms`), deviations by the fit's covariance.
    from_tolerances : ModelScatter
        Their deviations by the arm's tolerances.
    """

    arm: Arm
    posture_deg: tuple[float, ...]
    freedoms: tuple[str, ...]
    predicted: PredictedModes
    from_tolerances: ModelScatter


def predict_posture(arm: Arm, result: Identification, posture_deg: Sequence[float]) -> Prediction:
    """Predict the modes of a posture from what a session identified.

    Raises
    ------
    ArmError
        If the posture has another number of angles, or one outside its joint's range.
    EstimateError
        If the model does not oscillate in that posture.
    """
    joints_rad = wanted_posture(arm, posture_deg)
    superset = Superset(held_arm(arm).arm)
    predicted = predict_modes(
        superset,
        superset.posture(joints_rad),
        result.fit,
        added_mass_kg=np.zeros(len(arm.points)),
    )
    structure = result.fit.state.structure
    return Prediction(
        arm=arm,
        posture_deg=tuple(posture_deg),
        freedoms=(
            *(arm.joints[joint].name for joint in structure.joints),
            *(f"axis in {arm.joints[axis.link].link.name}" for axis in structure.axes),
            *(() if structure.held is None else structure.held.names),
        ),
        predicted=predicted,
        from_tolerances=prediction_model_std(
            joints_rad, result.fit, result.model_moves, base=predicted.modes
        ),
    )
