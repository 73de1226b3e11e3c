"""Modes the fitted model predicts for a posture, with the uncertainty of the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.arm.reduced import ModelModes, ReducedModel, model_modes, reduce_model
from analyzer.arm.structure import Structure
from analyzer.arm.superset import PostureDynamics, Superset
from analyzer.identification.frf_fit import FrfFit
from analyzer.identification.parameters import step_state

__all__ = ["PredictedModes", "predict_modes"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedModes:
    """Model modes of a posture with standard uncertainties from the fit's covariance."""

    model: ReducedModel
    modes: ModelModes
    f_std_hz: Array  # (n,)
    f_dof: Array  # (n,) degrees of freedom behind it
    damping_std: Array  # (n,)


def predict_modes(
    superset: Superset, dynamics: PostureDynamics, fit: FrfFit, *, added_mass_kg: Array
) -> PredictedModes:
    """Predict the modes of a posture from a fit made on others.

    Parameters
    ----------
    added_mass_kg
        (n_points,) mass at each test point: the roving sensor's, shared among its mountings.
    """

    def modes_of(structure: Structure) -> tuple[ReducedModel, ModelModes]:
        model = reduce_model(superset, dynamics, structure, added_mass_kg=added_mass_kg)
        return model, model_modes(model)

    model, modes = modes_of(fit.state.structure)
    n = len(fit.parameters.names)
    f_slope, damping_slope = np.zeros((n, modes.f_hz.size)), np.zeros((n, modes.f_hz.size))
    # Central differences; 1e-5 in a logarithm or an angle leaves an error near 1e-10.
    n_structural = 2 * len(fit.state.structure.joints) + 6 * len(fit.state.structure.axes)
    for i in range(n_structural):
        step = np.zeros(n)
        step[i] = 1e-5
        _, ahead = modes_of(step_state(fit.state, step).structure)
        _, behind = modes_of(step_state(fit.state, -step).structure)
        f_slope[i] = (ahead.f_hz - behind.f_hz) / 2e-5
        damping_slope[i] = (ahead.damping_ratio - behind.damping_ratio) / 2e-5
    return PredictedModes(
        model=model,
        modes=modes,
        f_std_hz=fit.scatter.std(f_slope),
        f_dof=fit.scatter.degrees_of_freedom(f_slope),
        damping_std=fit.scatter.std(damping_slope),
    )
