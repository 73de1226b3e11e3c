"""From a session to stiffness: FRFs, modes, model fit, axes, validation, in one pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from analyzer.arm.inertia import moments_about_joints
from analyzer.arm.structure import believed_structure
from analyzer.arm.superset import Superset
from analyzer.identification.axis_results import axis_results
from analyzer.identification.axis_search import best_axis_fit, start_state
from analyzer.identification.frf_fit import FrfFit, fit_frfs
from analyzer.identification.frf_model import PostureData, posture_data
from analyzer.identification.mode_fit import (
    MeasuredModes,
    fit_to_frequencies,
    pair_by_shape,
)
from analyzer.identification.model_error import model_error_std
from analyzer.identification.prediction import PredictedModes, predict_modes
from analyzer.identification.records import (
    Identification,
    JointResult,
    ModeResult,
    ValidationResult,
)
from analyzer.identification.scatter import FEWEST_DOF
from analyzer.identification.structural import STRUCTURAL_SHARE, joint_share
from analyzer.modal import ModalModel, Mode, fit_modes, posture_frf
from protocols.errors import EstimateError
from protocols.frf_records import FrequencyResponse
from protocols.session.records import Session

__all__ = ["estimate_frfs", "identify"]

Array = npt.NDArray[np.float64]

BAND_ABOVE = 1.5  # the model is fitted up to this multiple of the highest fitted mode
SEARCH_STRIDE = 4  # lines skipped while axes are searched
OWN_MODE_SHARE = 0.8  # of a mode's strain energy, for the one-joint method
UNEXPLAINED = 0.1  # of the rms motion; a sound model leaves a few per cent to mountings and aim
MIN_MAC = 0.5  # shapes less alike than this are not the same mode


def estimate_frfs(session: Session, superset: Superset) -> tuple[FrequencyResponse, ...]:
    """Accelerance of every planned posture with accepted hits, in plan order."""
    frfs = []
    for posture in session.header.plan.postures:
        if not session.accepted(posture.name):
            continue
        measured = [
            reading.joints_rad
            for hit in session.accepted(posture.name)
            for reading in (hit.before, hit.after)
            if reading.joints_rad is not None
        ]
        rotation = superset.posture(np.mean(measured, axis=0)).point_rotation
        directions = {p: rotation[i] for p, i in superset.point_index.items()}
        frfs.append(posture_frf(session, posture.name, directions))
    return tuple(frfs)


def identify(session: Session, progress: Callable[[str], None] | None = None) -> Identification:
    """Identify joint stiffness, damping and structural axes from a session.

    Postures marked for validation are predicted from the others before their modes are fitted.

    Raises
    ------
    EstimateError
        If the session holds no posture to fit, no joint of the arm is elastic, or the fit fails.
    """
    say = progress or (lambda _: None)
    superset = Superset(session.header.arm)
    validation = {p.name for p in session.header.plan.postures if p.validation}
    say("FRFs")
    frfs = estimate_frfs(session, superset)
    fitted = tuple(frf for frf in frfs if frf.posture not in validation)
    held_out = tuple(frf for frf in frfs if frf.posture in validation)
    if not fitted:
        raise EstimateError(
            "wanted at least one posture that is not for validation, with accepted hits; "
            "the session has none; measure one"
        )
    say("modes")
    models = tuple(fit_modes(frf) for frf in fitted)
    measured = _measured(superset, fitted, models)
    shares = [[joint_share(superset, m, mode.shape) for mode in m.modes] for m in measured]
    mass_kg = session.header.plan.sensor.mass_kg
    top_hz = BAND_ABOVE * max(mode.f_hz for model in models for mode in model.modes)
    banded = [_band(frf, top_hz) for frf in fitted]
    fit, rivals = _fit(superset, banded, measured, shares, mass_kg, say)
    say("uncertainty")
    coarse = _data(superset, banded, mass_kg, SEARCH_STRIDE)
    model_std = model_error_std(superset, coarse, fit)
    say("prediction")
    predictions = [
        predict_modes(
            superset,
            superset.posture(_angles(frf)),
            fit,
            added_mass_kg=_roving_mass(superset, frf, mass_kg),
        )
        for frf in frfs
    ]
    held_out_models = tuple(fit_modes(frf) for frf in held_out)
    checked = _measured(superset, held_out, held_out_models)
    by_posture = {frf.posture: p for frf, p in zip(frfs, predictions, strict=True)}
    fit_predictions = [by_posture[frf.posture] for frf in fitted]
    return Identification(
        joints=_joints(superset, fit, model_std, fitted, measured, fit_predictions),
        axes=axis_results(superset, fit, model_std, fitted, measured, shares, fit_predictions),
        modes=_modes(fitted, measured, shares, fit_predictions),
        validation=tuple(
            result
            for frf, m in zip(held_out, checked, strict=True)
            for result in _validate(frf, m, by_posture[frf.posture])
        ),
        rivals=rivals,
        fit=fit,
        modal_models=models + held_out_models,
        frfs=fitted + held_out,
        notes=_notes(fit, fitted, shares),
    )


def _fit(
    superset: Superset,
    banded: list[FrequencyResponse],
    measured: list[MeasuredModes],
    shares: list[list[float]],
    mass_kg: float,
    say: Callable[[str], None],
) -> tuple[FrfFit, tuple[tuple[str, float], ...]]:
    believed = believed_structure(superset.arm)
    if not believed.joints:
        raise EstimateError(
            f"arm '{superset.arm.name}' has no elastic joint: give at least one a stiffness in "
            "the arm file"
        )
    baseline = fit_to_frequencies(superset, believed, tuple(measured))
    full = _data(superset, banded, mass_kg, 1)
    flagged = [
        (share, at, mode)
        for at, posture in enumerate(shares)
        for mode, share in enumerate(posture)
        if share < STRUCTURAL_SHARE
    ]
    if not flagged:
        say("model fit")
        return fit_frfs(superset, full, start_state(baseline, len(full))), ()
    _, at, mode = min(flagged)
    coarse = _data(superset, banded, mass_kg, SEARCH_STRIDE)
    best, rivals = best_axis_fit(superset, baseline, coarse, measured, (at, mode), say)
    say("model fit, all lines")
    return fit_frfs(superset, full, best.state), rivals


def _measured(
    superset: Superset, frfs: tuple[FrequencyResponse, ...], models: tuple[ModalModel, ...]
) -> list[MeasuredModes]:
    return [
        MeasuredModes(superset, superset.posture(_angles(frf)), model.modes, frf.responses)
        for frf, model in zip(frfs, models, strict=True)
    ]


def _angles(frf: FrequencyResponse) -> Array:
    if frf.joints_rad is None:
        raise EstimateError(
            f"posture '{frf.posture}' has no measured joint angles: no model can be set beside it"
        )
    return frf.joints_rad


def _band(frf: FrequencyResponse, top_hz: float) -> FrequencyResponse:
    keep = frf.freq_hz <= top_hz
    return replace(
        frf,
        freq_hz=frf.freq_hz[keep],
        values=frf.values[..., keep],
        variance=frf.variance[..., keep],
        coherence=frf.coherence[..., keep],
    )


def _data(
    superset: Superset, frfs: list[FrequencyResponse], mass_kg: float, stride: int
) -> tuple[PostureData, ...]:
    return tuple(posture_data(superset, frf, sensor_mass_kg=mass_kg, stride=stride) for frf in frfs)


def _roving_mass(superset: Superset, frf: FrequencyResponse, mass_kg: float) -> Array:
    """The sensor's mass shared among the points it was mounted on, (n_points,)."""
    mass = np.zeros(len(superset.arm.points))
    points = {dof.point for dof in frf.responses}
    for point in points:
        mass[superset.point_index[point]] = mass_kg / len(points)
    return mass


def _joints(
    superset: Superset,
    fit: FrfFit,
    model_std: Array,
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    predictions: list[PredictedModes],
) -> tuple[JointResult, ...]:
    structure = fit.state.structure
    std, dof = fit.scatter.std(), fit.scatter.degrees_of_freedom()
    n = len(structure.joints)
    believed = believed_structure(superset.arm)
    results = []
    for i, joint in enumerate(structure.joints):
        k, c = structure.stiffness_n_m_per_rad[i], structure.damping_n_m_s_per_rad[i]
        own = _own_mode(i, measured, predictions)
        one_k = one_c = f_hz = posture = None
        if own is not None:
            at, mode = own
            inertia = moments_about_joints(superset.arm, measured[at].dynamics.T_base_link)[joint]
            f_hz, posture = mode.f_hz, frfs[at].posture
            one_k = float((2 * np.pi * f_hz) ** 2 * inertia)  # 000 Eq. (1), 002 Eq. (11)
            one_c = mode.damping_ratio * one_k / (np.pi * f_hz)  # 000 Eq. (2), 002 Eq. (12)
        results.append(
            JointResult(
                joint=superset.arm.joints[joint].name,
                k_n_m_per_rad=float(k),
                k_std=float(k * std[i]),
                k_dof=float(dof[i]),
                k_std_model=float(k * model_std[i]),
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
    return pair_by_shape(posture.shapes(), shapes)


def _modes(
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    shares: list[list[float]],
    predictions: list[PredictedModes],
) -> tuple[ModeResult, ...]:
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
                    structural=share[i] < STRUCTURAL_SHARE,
                    model_f_hz=None if pair is None else float(predicted.modes.f_hz[pair[0]]),
                    mac=None if pair is None else pair[1],
                )
            )
    return tuple(results)


def _validate(
    frf: FrequencyResponse, posture: MeasuredModes, predicted: PredictedModes
) -> list[ValidationResult]:
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
                measured_hz=None if mode is None else mode.f_hz,
                measured_std_hz=None if mode is None else mode.f_std_hz,
                measured_dof=None if mode is None else mode.dof,
                mac=pairs[j][1] if j in pairs else None,
            )
        )
    return results


def _notes(
    fit: FrfFit, fitted: tuple[FrequencyResponse, ...], shares: list[list[float]]
) -> tuple[str, ...]:
    flagged = sum(share < STRUCTURAL_SHARE for posture in shares for share in posture)
    notes = [
        f"{flagged} measured mode(s) are not explained by joint rotations"
        if flagged
        else "every measured mode is explained by joint rotations; no structural axis was sought",
        "relative FRF residual by posture: "
        + ", ".join(f"{value:.1%}" for value in fit.relative_residual),
    ]
    unexplained = [
        f"{frf.posture} {value:.0%}"
        for frf, value in zip(fitted, fit.relative_residual, strict=True)
        if value > UNEXPLAINED
    ]
    if unexplained:
        notes.append(
            f"the model leaves more than {UNEXPLAINED:.0%} of the motion unexplained "
            f"({', '.join(unexplained)}): it lacks an effect, and its stiffnesses and their "
            "standard deviations are not to be relied on"
        )
    poorly = [
        name
        for name, nu in zip(fit.parameters.names, fit.scatter.degrees_of_freedom(), strict=True)
        if nu < FEWEST_DOF
    ]
    if poorly:
        notes.append(
            "seen by fewer than three mountings, so that the stated std is the least it can be: "
            + ", ".join(poorly)
        )
    return tuple(notes)
