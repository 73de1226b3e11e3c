"""From the superset to the few degrees of freedom a structure frees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.arm.structure import Structure
from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.protocols.errors import EstimateError

__all__ = ["ModelModes", "ReducedModel", "model_modes", "reduce_model", "selection"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReducedModel:
    """M q'' + C q' + K q = Jᵀ f of one posture; n freedoms of a structure.

    Equation: file 002, Eq. (2), gravity's stiffness included in K.
    """

    mass: Array  # (n, n)
    damping: Array  # (n, n)
    stiffness: Array  # (n, n), springs plus gravity
    point_jacobian: Array  # (n_points, 6, n), base frame, linear first
    names: tuple[str, ...]  # (n,) of the freedoms


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelModes:
    """Complex modes of a reduced model, lowest frequency first."""

    pole_rad_s: npt.NDArray[np.complex128]  # (n,), positive imaginary part
    f_hz: Array  # (n,), |pole| / 2 pi
    damping_ratio: Array  # (n,)
    shape: npt.NDArray[np.complex128]  # (n, n), columns, in the structure's freedoms


def selection(superset: Superset, structure: Structure) -> Array:
    """Return T (superset.n, n): the superset's motion for each freedom of the structure."""
    T = np.zeros((superset.n, structure.n))
    for column, joint in enumerate(structure.joints):
        T[superset.joint_column(joint), column] = 1.0
    for column, axis in enumerate(structure.axes, start=len(structure.joints)):
        T[superset.interface_columns(axis.link), column] = axis.twist()
    if structure.held is not None:
        T[:, structure.n - len(structure.held.names) :] = structure.held.motion
    return T


def reduce_model(
    superset: Superset,
    dynamics: PostureDynamics,
    structure: Structure,
    *,
    added_mass_kg: Array | None = None,
) -> ReducedModel:
    """Reduce a posture of the superset to the structure's freedoms.

    Parameters
    ----------
    added_mass_kg
        (n_points,) masses that ride on the test points (an accelerometer, or its mean over
        several mountings); none when omitted.
    """
    T = selection(superset, structure)
    jacobian = dynamics.point_jacobian @ T
    mass = T.T @ dynamics.mass @ T + structure.held_mass()
    if added_mass_kg is not None:
        linear = jacobian[:, :3]
        mass = mass + np.einsum("p,pij,pik->jk", added_mass_kg, linear, linear)
    return ReducedModel(
        mass=mass,
        damping=structure.dampers(),
        stiffness=T.T @ dynamics.gravity_stiffness @ T + structure.springs(),
        point_jacobian=jacobian,
        names=_names(superset, structure),
    )


def model_modes(model: ReducedModel) -> ModelModes:
    """Complex modes of a reduced model from its state matrix.

    Raises
    ------
    EstimateError
        If a mode does not oscillate (damping at or above critical, or an unstable posture).
    """
    n = model.mass.shape[0]
    lower = np.linalg.solve(model.mass, np.hstack([-model.stiffness, -model.damping]))
    state = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower])
    poles, vectors = scipy.linalg.eig(state)
    oscillating = np.flatnonzero(poles.imag > 0)
    if oscillating.size != n:
        raise EstimateError(
            f"wanted {n} oscillating modes, the model has {oscillating.size}; {_why_still(model)}"
        )
    order = oscillating[np.argsort(np.abs(poles[oscillating]))]
    pole = poles[order]
    return ModelModes(
        pole_rad_s=pole,
        f_hz=np.abs(pole) / (2 * np.pi),
        damping_ratio=-pole.real / np.abs(pole),
        shape=vectors[:n, order],
    )


def _names(superset: Superset, structure: Structure) -> tuple[str, ...]:
    joints = superset.arm.joints
    held = () if structure.held is None else structure.held.names
    return (
        *(joints[i].name for i in structure.joints),
        *(f"the axis in {joints[axis.link].link.name}" for axis in structure.axes),
        *held,
    )


def _why_still(model: ReducedModel) -> str:
    """Which freedoms do not oscillate by themselves, the others held."""
    m, c, k = (np.diag(matrix) for matrix in (model.mass, model.damping, model.stiffness))
    falls = [name for name, own in zip(model.names, k, strict=True) if own <= 0.0]
    creeps = [
        f"{name} ({part:.1f} of critical)"
        for name, part in zip(
            model.names, c / (2.0 * np.sqrt(np.maximum(k * m, 1e-300))), strict=True
        )
        if part >= 1.0 and name not in falls
    ]
    if falls:
        return f"nothing holds {', '.join(falls)}: check the stiffness in the arm file"
    if creeps:
        return (
            f"damped above critical: {', '.join(creeps)}; check damping or loss in the arm file, "
            "or leave the effect out"
        )
    return "check that every stiffness is positive and no damping is above critical"
