"""The structural axes of a fit, beside the Mozzi axes of the modes they make."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.structure import Axis
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.frf_fit import FrfFit
from armodal.analyzer.identification.mode_fit import MeasuredModes, pair_by_shape
from armodal.analyzer.identification.prediction import PredictedModes
from armodal.analyzer.identification.records import AxisResult, LineReading, MozziOfMode
from armodal.analyzer.identification.structural import (
    STRUCTURAL_SHARE,
    moment_about,
    mozzi_of_shape,
    to_link,
    triplets_of_shape,
)
from armodal.analyzer.screws import line_angle_rad, line_distance_m, line_sense
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["axis_results"]

Array = npt.NDArray[np.float64]

UNTOLD = 0.5  # of ln k: a stiffness that could as well be half or twice as large
PARALLEL_DEG, NEAR_M = 10.0, 0.03  # of a joint's axis: nearer, two springs in series look as one


def axis_results(
    superset: Superset,
    fit: FrfFit,
    model_std: Array,
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    shares: list[list[float]],
    predictions: list[PredictedModes],
) -> tuple[AxisResult, ...]:
    """Report every axis of the fitted structure."""
    structure = fit.state.structure
    std, dof = fit.scatter.std(), fit.scatter.degrees_of_freedom()
    results = []
    for number, fitted in enumerate(structure.axes):
        axis = replace(fitted, direction=line_sense(fitted.direction))
        at = 2 * len(structure.joints) + 6 * number
        freedom = len(structure.joints) + number
        mozzi = _mozzi(superset, axis, frfs, measured, shares, predictions)
        posture, f_hz = _strained_mode(freedom, frfs, shares, predictions)
        results.append(
            AxisResult(
                link=superset.arm.joints[axis.link].link.name,
                direction_link=axis.direction,
                point_link_m=axis.point_m,
                direction_std_deg=float(np.rad2deg(np.hypot(std[at], std[at + 1]))),
                point_std_m=float(np.hypot(std[at + 2], std[at + 3])),
                f_hz=f_hz,
                posture=posture,
                k_n_m_per_rad=axis.stiffness_n_m_per_rad,
                k_std=float(axis.stiffness_n_m_per_rad * std[at + 4]),
                k_dof=float(dof[at + 4]),
                k_std_model=float(axis.stiffness_n_m_per_rad * model_std[at + 4]),
                k_alone_n_m_per_rad=axis.stiffness_n_m_per_rad,
                k_alone_std_model=float(axis.stiffness_n_m_per_rad * model_std[at + 4]),
                c_n_m_s_per_rad=axis.damping_n_m_s_per_rad,
                c_std=float(axis.damping_n_m_s_per_rad * std[at + 5]),
                c_dof=float(dof[at + 5]),
                mozzi=mozzi,
                doubts=_doubts(superset, axis, mozzi, float(std[at + 4])),
            )
        )
    return tuple(results)


def _strained_mode(
    freedom: int,
    frfs: tuple[FrequencyResponse, ...],
    shares: list[list[float]],
    predictions: list[PredictedModes],
) -> tuple[str, float]:
    """Posture and fitted frequency of the mode that strains the axis most.

    Looked for in the first posture whose measured modes showed the structure.
    """
    at = next(
        (i for i, share in enumerate(shares) if min(share, default=1.0) < STRUCTURAL_SHARE), 0
    )
    modes, model = predictions[at].modes, predictions[at].model
    energy = np.diag(model.stiffness)[:, None] * np.abs(modes.shape) ** 2
    strained = int(np.argmax(energy[freedom] / energy.sum(axis=0)))
    return frfs[at].posture, float(modes.f_hz[strained])


def _mozzi(
    superset: Superset,
    axis: Axis,
    frfs: tuple[FrequencyResponse, ...],
    measured: list[MeasuredModes],
    shares: list[list[float]],
    predictions: list[PredictedModes],
) -> tuple[MozziOfMode, ...]:
    results = []
    for frf, posture, share, predicted in zip(frfs, measured, shares, predictions, strict=True):
        shapes = posture.rows(predicted.model.point_jacobian) @ predicted.modes.shape
        if not posture.modes:
            continue
        pairs = {i: j for i, j, _ in pair_by_shape(posture.shapes, shapes)}
        for i, mode in enumerate(posture.modes):
            if share[i] >= STRUCTURAL_SHARE or i not in pairs:
                continue
            found = mozzi_of_shape(superset, posture, posture.shapes[:, i], axis.link)
            expected = mozzi_of_shape(superset, posture, shapes[:, pairs[i]], axis.link)
            if found is None or expected is None:
                continue
            read = to_link(posture.dynamics, axis.link, found)
            k, inertia = _equation_one(superset, posture, axis, read, mode.f_hz)
            triplets = triplets_of_shape(superset, posture, posture.shapes[:, i], axis.link)
            average = (
                None
                if triplets is None
                else _line_to_link(posture, axis, triplets.direction, triplets.point_m)
            )
            line = to_link(posture.dynamics, axis.link, expected)
            expected_f_hz = float(predicted.modes.f_hz[pairs[i]])
            expected_k, _ = _equation_one(superset, posture, axis, line, expected_f_hz)
            off_m = line_distance_m(_near_joint(superset, axis), line[1], line[0])
            results.append(
                MozziOfMode(
                    posture=frf.posture,
                    f_hz=mode.f_hz,
                    direction_base=found.direction,
                    point_base_m=found.point_m,
                    pitch_m_per_rad=found.pitch_m_per_rad,
                    inertia_kg_m2=inertia,
                    k_eq1_n_m_per_rad=k,
                    c_eq2_n_m_s_per_rad=mode.damping_ratio * k / (np.pi * mode.f_hz),
                    line=_reading(superset, axis, read),
                    predicted_bias_deg=float(np.rad2deg(line_angle_rad(line[0], axis.direction))),
                    predicted_bias_mm=1e3 * off_m,
                    predicted_bias_k=expected_k / axis.stiffness_n_m_per_rad - 1.0,
                    triplets=triplets,
                    triplet_line=None if average is None else _reading(superset, axis, average),
                )
            )
    return tuple(results)


def _line_to_link(
    posture: MeasuredModes, axis: Axis, direction: Array, point_m: Array
) -> tuple[Array, Array]:
    T = posture.dynamics.T_base_link[axis.link]
    return T[:3, :3].T @ direction, T[:3, :3].T @ (point_m - T[:3, 3])


def _reading(superset: Superset, axis: Axis, line: tuple[Array, Array]) -> LineReading:
    direction, point = line
    if direction @ axis.direction < 0.0:
        direction = -direction
    near = _near_joint(superset, axis)
    return LineReading(
        direction_link=direction,
        point_link_m=point - direction * (direction @ point),
        off_deg=float(np.rad2deg(line_angle_rad(direction, axis.direction))),
        off_mm=1e3 * line_distance_m(near, point, direction),
    )


def _near_joint(superset: Superset, axis: Axis) -> Array:
    """Point of an axis nearest the joint at its link's far end: there distances are taken."""
    beyond = axis.link + 1
    if beyond == superset.n_joints:
        return axis.point_m
    joint_m = superset.arm.joints[beyond].T_parent_joint[:3, 3]
    return np.asarray(axis.point_m + axis.direction * (axis.direction @ joint_m))


def _doubts(
    superset: Superset, axis: Axis, mozzi: tuple[MozziOfMode, ...], log_k_std: float
) -> tuple[str, ...]:
    """What speaks against reading the axis as a compliance of its own."""
    doubts = []
    if log_k_std > UNTOLD:
        doubts.append(
            f"the measurement hardly shows the axis: the standard deviation of its stiffness is "
            f"{100 * log_k_std:.0f} % of it; no compliance there is established"
        )
    joints = superset.arm.joints
    # The joint that moves the link turns about its own axis through the link frame's origin.
    near = joints[axis.link]
    angle = float(np.rad2deg(line_angle_rad(near.axis, axis.direction)))
    away = line_distance_m(np.zeros(3), axis.point_m, axis.direction)
    if near.stiffness is not None and angle < PARALLEL_DEG and away < NEAR_M:
        doubts.append(
            f"the axis is {angle:.0f} degrees and {1e3 * away:.0f} mm from {near.name}'s: its "
            "compliance and the joint's can hardly be told apart"
        )
    if axis.link + 1 < len(joints):
        outer = joints[axis.link + 1]
        T = outer.T_parent_joint
        angle = float(np.rad2deg(line_angle_rad(T[:3, :3] @ outer.axis, axis.direction)))
        away = line_distance_m(T[:3, 3], axis.point_m, axis.direction)
        if outer.stiffness is not None and angle < PARALLEL_DEG and away < NEAR_M:
            doubts.append(
                f"the axis is {angle:.0f} degrees and {1e3 * away:.0f} mm from {outer.name}'s: its "
                "compliance and the joint's can hardly be told apart"
            )
    if all(row.triplets is None for row in mozzi):
        doubts.append(
            "no two triplets of triaxial points behind the axis span a plane: the axis rests on "
            "the model alone; measure three points that are not in line"
        )
    return tuple(doubts)


def _equation_one(
    superset: Superset,
    posture: MeasuredModes,
    axis: Axis,
    line: tuple[Array, Array],
    f_hz: float,
) -> tuple[float, float]:
    """K = (2 pi f)² I about a line of the link, and I (file 000, Eq. 1)."""
    direction, point = line
    inertia = moment_about(
        superset, posture.dynamics, replace(axis, direction=direction, point_m=point)
    )
    return (2 * np.pi * f_hz) ** 2 * inertia, inertia
