"""Rows of an identification: joints, modes, validation, and what is to be said of the fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.inertia import moments_about_joints
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.frf_fit import FrfFit
from armodal.analyzer.identification.mode_fit import MeasuredModes, pair_by_shape
from armodal.analyzer.identification.prediction import PredictedModes
from armodal.analyzer.identification.records import JointResult, ModeResult, ValidationResult
from armodal.analyzer.identification.scatter import FEWEST_DOF
from armodal.analyzer.identification.structural import STRUCTURAL_SHARE
from armodal.analyzer.modal import Mode
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["UNEXPLAINED", "fit_notes", "joint_results", "mode_results", "validation_results"]

Array = npt.NDArray[np.float64]

OWN_MODE_SHARE = 0.8  # of a mode's strain energy, for the one-joint method
UNEXPLAINED = 0.1  # of the rms motion; a sound model leaves a few per cent to mountings and aim
MIN_MAC = 0.5  # shapes less alike than this are not the same mode


def joint_results(
    superset: Superset,
    fit: FrfFit,
    model_std: Array,
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    predictions: list[PredictedModes],
) -> tuple[JointResult, ...]:
    """Stiffness and damping of every elastic joint, from the fit and from one mode alone."""
    structure = fit.state.structure
    std, dof = fit.scatter.std(), fit.scatter.degrees_of_freedom()
    n = len(structure.joints)
    believed = believed_structure(superset.arm)
    beside = structure.held_alone()
    mass, spring, damper = (
        np.diag(matrix) for matrix in (beside.held_mass(), beside.springs(), beside.dampers())
    )
    results = []
    for i, joint in enumerate(structure.joints):
        k, c = structure.stiffness_n_m_per_rad[i], structure.damping_n_m_s_per_rad[i]
        own = _own_mode(i, measured, predictions)
        one_k = one_c = f_hz = posture = None
        if own is not None:
            at, mode = own
            inertia = moments_about_joints(superset.arm, measured[at].dynamics.T_base_link)[joint]
            f_hz, posture = mode.f_hz, frfs[at].posture
            whole = (2 * np.pi * f_hz) ** 2 * (inertia + mass[i])  # 000 Eq. (1), 002 Eq. (11)
            one_k = float(whole - spring[i])
            one_c = float(mode.damping_ratio * whole / (np.pi * f_hz) - damper[i])  # Eqs. (2), (12)
        results.append(
            JointResult(
                joint=superset.arm.joints[joint].name,
                k_n_m_per_rad=float(k),
                k_std=float(k * std[i]),
                k_dof=float(dof[i]),
                k_std_model=float(k * model_std[i]),
                k_alone_n_m_per_rad=float(k),
                k_alone_std_model=float(k * model_std[i]),
                c_n_m_s_per_rad=float(c),
                c_std=float(c * std[n + i]),
                c_dof=float(dof[n + i]),
                believed_k_n_m_per_rad=float(believed.stiffness_n_m_per_rad[i]),
                k_one_joint_n_m_per_rad=one_k,
                c_one_joint_n_m_s_per_rad=one_c,
                one_joint_posture=posture,
                one_joint_f_hz=f_hz,
            )
        )
    return tuple(results)


def _own_mode(
    freedom: int, measured: list[MeasuredModes], predictions: list[PredictedModes]
) -> tuple[int, Mode] | None:
    """The measured mode with the largest strain share of one spring, if large enough."""
    best: tuple[float, int, Mode] | None = None
    for at, (posture, predicted) in enumerate(zip(measured, predictions, strict=True)):
        energy = np.diag(predicted.model.stiffness)[:, None] * np.abs(predicted.modes.shape) ** 2
        share = energy[freedom] / energy.sum(axis=0)
        for i, j, mac in _pairs(posture, predicted):
            if (
                mac >= MIN_MAC
                and share[j] >= OWN_MODE_SHARE
                and (best is None or share[j] > best[0])
            ):
                best = (float(share[j]), at, posture.modes[i])
    return None if best is None else (best[1], best[2])


def _pairs(posture: MeasuredModes, predicted: PredictedModes) -> list[tuple[int, int, float]]:
    if not posture.modes:
        return []
    shapes = posture.rows(predicted.model.point_jacobian) @ predicted.modes.shape
    return pair_by_shape(posture.shapes, shapes)


def mode_results(
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    shares: list[list[float]],
    predictions: list[PredictedModes],
    beyond_joints: bool,
) -> tuple[ModeResult, ...]:
    """Every measured mode, what moves in it, and its partner in the model."""
    results = []
    for frf, posture, share, predicted in zip(frfs, measured, shares, predictions, strict=True):
        pairs = {i: (j, mac) for i, j, mac in _pairs(posture, predicted) if mac >= MIN_MAC}
        for i, mode in enumerate(posture.modes):
            pair = pairs.get(i)
            results.append(
                ModeResult(
                    posture=frf.posture,
                    f_hz=mode.f_hz,
                    f_std_hz=mode.f_std_hz,
                    damping_ratio=mode.damping_ratio,
                    damping_std=mode.damping_std,
                    mpc=mode.mpc,
                    joint_share=share[i],
                    structural=beyond_joints and share[i] < STRUCTURAL_SHARE,
                    model_f_hz=None if pair is None else float(predicted.modes.f_hz[pair[0]]),
                    mac=None if pair is None else pair[1],
                )
            )
    return tuple(results)


def validation_results(
    frf: FrequencyResponse, posture: MeasuredModes, predicted: PredictedModes
) -> list[ValidationResult]:
    """Predicted modes of a posture the fit has not seen beside the measured ones."""
    pairs = {j: (i, mac) for i, j, mac in _pairs(posture, predicted) if mac >= MIN_MAC}
    results = []
    for j, f_hz in enumerate(predicted.modes.f_hz):
        mode = posture.modes[pairs[j][0]] if j in pairs else None
        results.append(
            ValidationResult(
                posture=frf.posture,
                mode=j + 1,
                predicted_hz=float(f_hz),
                predicted_std_hz=float(predicted.f_std_hz[j]),
                predicted_dof=float(predicted.f_dof[j]),
                predicted_damping=float(predicted.modes.damping_ratio[j]),
                predicted_damping_std=float(predicted.damping_std[j]),
                measured_hz=None if mode is None else mode.f_hz,
                measured_std_hz=None if mode is None else mode.f_std_hz,
                measured_dof=None if mode is None else mode.dof,
                measured_damping=None if mode is None else mode.damping_ratio,
                measured_damping_std=None if mode is None else mode.damping_std,
                mac=pairs[j][1] if j in pairs else None,
            )
        )
    return results


def fit_notes(
    fit: FrfFit,
    fitted: tuple[FrequencyResponse, ...],
    shares: list[list[float]],
    beside: Sequence[str],
) -> tuple[str, ...]:
    """What has to be said of a fit before its numbers are used.

    `beside` is what there is to say of a fit beside what is ordinary, if there is one.
    """
    flagged = sum(share < STRUCTURAL_SHARE for posture in shares for share in posture)
    modes = f"{flagged} measured mode{'' if flagged == 1 else 's'}"
    if fit.state.structure.axes:
        first = f"joint rotations do not explain {modes}"
    elif not flagged:
        first = (
            "joint rotations make the shape of every measured mode; no structural axis was sought"
        )
    elif fit.relative_residual.max() < UNEXPLAINED:
        first = (
            f"joint rotations explain little of {modes}, yet the joints alone explain the "
            "FRFs: the roving sensor's mass, or noise; no structural axis was sought"
        )
    else:
        first = f"joint rotations explain little of {modes}"
    notes = [
        first,
        "part of the FRFs that neither model nor noise explains, rms: "
        + ", ".join(
            f"{frf.posture} {value:.1%}"
            for frf, value in zip(fitted, fit.relative_residual, strict=True)
        ),
    ]
    unexplained = [
        f"{frf.posture} {value:.0%}"
        for frf, value in zip(fitted, fit.relative_residual, strict=True)
        if value > UNEXPLAINED
    ]
    if unexplained and beside:
        notes += beside
    elif unexplained:
        notes.append(
            f"the model leaves more than {UNEXPLAINED:.0%} of the motion unexplained "
            f"({', '.join(unexplained)}): it lacks an effect, or masses and places are off, and "
            "its stiffnesses may be off by more than their deviations; `armodal gap` tells which"
        )
    poorly = [
        name
        for name, nu in zip(fit.parameters.names, fit.scatter.degrees_of_freedom(), strict=True)
        if nu < FEWEST_DOF
    ]
    if fit.scatter.one_mounting:
        notes.append(
            "the parameters rest on one mounting alone, which shows no scatter: each standard "
            "deviation is that of the noise, and leaves out what a second mounting would show"
        )
    elif poorly:
        notes.append(
            "seen by fewer than three mountings, so that the standard deviation may be larger: "
            + ", ".join(poorly)
        )
    return tuple(notes)
