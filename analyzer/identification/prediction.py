"""Modes the fitted model predicts for a posture, with the uncertainty of the fit.

Scatter comes from the fit's covariance by the slopes of frequency, damping and shape. What the
inertias' and encoders' tolerances do is kept apart: every uncertain quantity is moved, the fit
answers (`model_error`), and arm and fit together predict the posture anew. So a link that is
heavier than believed, which makes k larger in the same proportion, hardly changes what is
predicted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.reduced import ModelModes, ReducedModel, model_modes, reduce_model
from armodal.analyzer.arm.structure import Structure
from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.identification.frf_fit import FrfFit
from armodal.analyzer.identification.mode_fit import pair_by_shape
from armodal.analyzer.identification.model_error import STEP, ModelMove
from armodal.analyzer.identification.parameters import step_state
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["ModelScatter", "PredictedModes", "predict_modes", "prediction_model_std", "roving_mass"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

SLOPE_STEP = 1e-5  # of a logarithm or an angle: central differences then err by 1e-10


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedModes:
    """Model modes of a posture with standard uncertainties from the fit's covariance.

    Shapes are scaled to 1 in their largest freedom.
    """

    model: ReducedModel
    modes: ModelModes
    f_std_hz: Array  # (n,)
    f_dof: Array  # (n,) degrees of freedom behind it
    damping_std: Array  # (n,)
    shape: ComplexArray  # (n, n), columns, in the structure's freedoms
    shape_std: Array  # (n, n), of the real parts
    strain_share: Array  # (n, n), each spring's part of a mode's strain energy, rows springs


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelScatter:
    """Standard uncertainties of predicted modes from the arm's tolerances."""

    f_std_hz: Array  # (n,)
    damping_std: Array  # (n,)
    shape_std: Array  # (n, n)


def predict_modes(
    superset: Superset, dynamics: PostureDynamics, fit: FrfFit, *, added_mass_kg: Array
) -> PredictedModes:
    """Predict the modes of a posture from a fit made on others.

    Parameters
    ----------
    added_mass_kg
        (n_points,) mass at each test point: the roving sensor's, shared among its mountings.

    Raises
    ------
    EstimateError
        If the fit ends with a drive that does not swing.
    """

    def modes_of(structure: Structure) -> tuple[ReducedModel, ModelModes]:
        model = reduce_model(superset, dynamics, structure, added_mass_kg=added_mass_kg)
        return model, model_modes(model)

    try:
        model, modes = modes_of(fit.state.structure)
    except EstimateError as problem:
        raise EstimateError(
            f"the fit ends with a drive that does not swing: {problem}. Its link's mass and "
            "moments in the arm file may be far from the arm's (docs/own-arm.md): correct them, or "
            "take its stiffness out so that it is believed rigid"
        ) from problem
    n, n_modes = len(fit.parameters.names), modes.f_hz.size
    slopes = np.zeros((n, n_modes * (2 + n_modes)))
    n_structural = 2 * len(fit.state.structure.joints) + 6 * len(fit.state.structure.axes)
    for i in range(n_structural):
        step = np.zeros(n)
        step[i] = SLOPE_STEP
        _, ahead = modes_of(step_state(fit.state, step).structure)
        _, behind = modes_of(step_state(fit.state, -step).structure)
        slopes[i] = (_quantities(ahead, modes) - _quantities(behind, modes)) / (2 * SLOPE_STEP)
    std = fit.scatter.std(slopes)
    energy = np.diag(fit.state.structure.springs())[:, None] * np.abs(modes.shape) ** 2
    return PredictedModes(
        model=model,
        modes=modes,
        f_std_hz=std[:n_modes],
        f_dof=fit.scatter.degrees_of_freedom(slopes[:, :n_modes]),
        damping_std=std[n_modes : 2 * n_modes],
        shape=modes.shape / _largest(modes.shape, _rows(modes.shape)),
        shape_std=std[2 * n_modes :].reshape(n_modes, n_modes),
        strain_share=energy / energy.sum(axis=0),
    )


def prediction_model_std(
    joints_rad: Array, fit: FrfFit, moves: tuple[ModelMove, ...], *, base: ModelModes
) -> ModelScatter:
    """What the arm's tolerances leave uncertain of the modes of a posture, no sensor on the arm.

    Parameters
    ----------
    base
        The modes with every quantity as believed.
    """
    n = base.f_hz.size
    variance = np.zeros(n * (2 + n))
    before = _quantities(base, base)
    for move in moves:
        superset = Superset(move.arm)
        structure = step_state(fit.state, move.step).structure
        model = reduce_model(superset, superset.posture(joints_rad + move.angles_rad), structure)
        variance += ((_quantities(model_modes(model), base) - before) / STEP) ** 2
    std = np.sqrt(variance)
    return ModelScatter(
        f_std_hz=std[:n], damping_std=std[n : 2 * n], shape_std=std[2 * n :].reshape(n, n)
    )


def roving_mass(superset: Superset, frf: FrequencyResponse, mass_kg: float) -> Array:
    """The roving sensor's mass shared among the points it was mounted on, (n_points,)."""
    mass = np.zeros(len(superset.arm.points))
    points = {dof.point for dof in frf.responses}
    for point in points:
        mass[superset.point_index[point]] = mass_kg / len(points)
    return mass


def _quantities(modes: ModelModes, base: ModelModes) -> Array:
    """Frequencies, damping ratios and real shapes, in the order and scaling of `base`."""
    order = np.array([j for _, j, _ in sorted(pair_by_shape(base.shape, modes.shape))])
    shape = modes.shape[:, order]
    scaled = (shape / _largest(shape, _rows(base.shape))).real
    return np.concatenate([modes.f_hz[order], modes.damping_ratio[order], scaled.ravel()])


def _rows(shape: ComplexArray) -> npt.NDArray[np.int64]:
    return np.asarray(np.argmax(np.abs(shape), axis=0))


def _largest(shape: ComplexArray, rows: npt.NDArray[np.int64]) -> ComplexArray:
    return np.asarray(shape[rows, np.arange(shape.shape[1])])
