"""What the tolerance of the inertias and encoders does to the fitted parameters.

The fit cannot see that a link is heavier than believed: k is proportional to inertia. Each
uncertain quantity p is moved a little, and the fit answers by one Gauss-Newton step,
dθ = -H⁻¹ Jᵀ W dy; the steps of independent quantities, dθ/dp times the standard deviation of p, add
as variances. The move is small because FRFs are sharp: a link heavier by its whole tolerance shifts
a resonance by as much as its width, where one step no longer tells what a fit would find.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.frf_fit import FrfFit, line_weights
from armodal.analyzer.identification.frf_model import PostureData, predict, predict_with_derivatives
from armodal.protocols.arm.records import Arm, InertialLink

__all__ = ["STEP", "ModelMove", "model_error_std", "model_moves", "moved_arms"]

Array = npt.NDArray[np.float64]

STEP = 1e-5  # of a standard deviation; rounding then costs 1e-7 of the answer


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelMove:
    """One uncertain quantity off by `STEP` standard deviations, and how the fit answers."""

    arm: Arm
    angles_rad: Array  # (n_joints,) added to what the encoders say
    step: Array  # (n_parameters,) of the fit


def model_error_std(moves: tuple[ModelMove, ...]) -> Array:
    """Standard deviation (n_parameters,) of the fitted parameters from the model's tolerances."""
    return np.asarray(np.sqrt(sum((move.step / STEP) ** 2 for move in moves)))


def model_moves(
    superset: Superset, postures: tuple[PostureData, ...], fit: FrfFit
) -> tuple[ModelMove, ...]:
    """Move every uncertain quantity of the arm a little and let the fit answer."""
    base, weighted_J = [], []
    H = np.diag(1.0 / fit.parameters.prior_std**2)
    for i, data in enumerate(postures):
        y, dy = predict_with_derivatives(superset, data, fit.state, i)
        J = np.asarray(dy).reshape(len(H), -1)
        weighted = J.conj() * line_weights(data).ravel()
        H = H + (weighted @ J.T).real
        base.append(y.ravel())
        weighted_J.append(weighted)
    moves = []
    for perturbed, angles in moved_arms(superset.arm):
        other = Superset(perturbed)
        gradient = np.zeros(len(H))
        there = other.postures([data.dynamics.joints_rad + angles for data in postures])
        for i, (data, dynamics) in enumerate(zip(postures, there, strict=True)):
            moved = replace(data, dynamics=dynamics)
            y = predict(other, moved, fit.state, i)
            gradient -= (weighted_J[i] @ (y.ravel() - base[i])).real
        step = np.asarray(np.linalg.solve(H, gradient), dtype=np.float64)
        moves.append(ModelMove(arm=perturbed, angles_rad=angles, step=step))
    return tuple(moves)


def moved_arms(arm: Arm) -> Iterator[tuple[Arm, Array]]:
    """Arms and encoder offsets, each with one quantity off by `STEP` standard deviations."""
    still = np.zeros(len(arm.joints))
    for factors in 1.0 + STEP * _mass_directions(arm).T:
        joints = tuple(
            replace(
                joint,
                link=replace(
                    joint.link,
                    mass_kg=joint.link.mass_kg * float(factor),
                    inertia_kg_m2=joint.link.inertia_kg_m2 * float(factor),
                ),
            )
            for joint, factor in zip(arm.joints, factors, strict=True)
        )
        yield replace(arm, joints=joints), still
    for i, joint in enumerate(arm.joints):
        link, std = joint.link, arm.inertial_std(joint)
        changes = [
            replace(link, center_m=link.center_m + STEP * std.center_m * side) for side in np.eye(3)
        ]
        changes += list(_principal(link, STEP * std.inertia))
        for changed in changes:
            own = (replace(joint, link=changed),)
            yield replace(arm, joints=arm.joints[:i] + own + arm.joints[i + 1 :]), still
    for i in range(len(arm.joints)):
        angles = still.copy()
        angles[i] = STEP * arm.tolerances.encoder_offset_rad
        yield arm, angles


def _mass_directions(arm: Arm) -> Array:
    """Independent changes of the links' masses, relative, one a column; their squares add.

    Where all moving links are weighed together, links heavier than believed leave less to others:
    the covariance of the masses is conditioned on their sum (C. Rasmussen, C. Williams, Gaussian
    Processes for Machine Learning, 2006, Eq. A.6).
    """
    mass = np.array([joint.link.mass_kg for joint in arm.joints])
    std = mass * [arm.inertial_std(joint).mass for joint in arm.joints]
    if arm.tolerances.moving_mass is None:
        return np.diag(std / mass)
    square = std**2
    of_sum = square.sum() + (arm.tolerances.moving_mass * mass.sum()) ** 2
    values, vectors = np.linalg.eigh(np.diag(square) - np.outer(square, square) / of_sum)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) / mass[:, None])


def _principal(link: InertialLink, tolerance: float) -> Iterator[InertialLink]:
    moments, axes = np.linalg.eigh(link.inertia_kg_m2)
    for i in range(3):
        changed = moments.copy()
        changed[i] *= 1.0 + tolerance
        yield replace(link, inertia_kg_m2=axes @ np.diag(changed) @ axes.T)
