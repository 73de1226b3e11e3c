"""Stiffness of chosen joints from natural frequencies alone: the penalty method of file 002.

The sum over all postures and modes of the squared difference between measured and predicted
natural frequency (Eq. 13) is made least over the stiffnesses chosen; the others stay. Modes are
paired by shape in every step, never by order: two modes may pass each other between the guess and
the answer. Damping follows from the modal damping of the same pairs, phiᵀ C phi (Eq. 6).

References
----------
File 002, Eqs. (6), (12), (13). The slope of a frequency by a stiffness is the spring's share of
the mode's strain energy: df / d ln k = f/2 · k φ² / (φᵀ K φ).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.arm.reduced import reduce_model
from armodal.analyzer.arm.structure import Structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes, pair_by_shape
from armodal.protocols.errors import EstimateError

__all__ = ["PairedMode", "PenaltyFit", "fit_by_penalty"]

Array = npt.NDArray[np.float64]

MIN_MAC = 0.5  # shapes less alike are not the same mode
LEAST_SHARE = 0.01  # of some paired mode's strain energy, or the spring is not seen
LARGEST_STEP = 0.3  # of ln k
CONVERGED = 1e-10
ITERATIONS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedMode:
    """A measured mode and the model's mode of the same shape."""

    posture: int
    measured_hz: float
    predicted_hz: float
    measured_damping: float
    predicted_damping: float
    mac: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PenaltyFit:
    """The stiffnesses at which the penalty of Eq. (13) is least."""

    chosen: tuple[int, ...]  # positions in the structure's joints
    structure: Structure
    k_std: Array  # (n_chosen,) N m/rad from the differences left; NaN where there are too few
    penalty_hz2: float
    pairs: tuple[PairedMode, ...]
    left_out: int  # measured modes of no model shape


@dataclass(frozen=True, slots=True, kw_only=True)
class _Pairs:
    f_measured: Array
    f_model: Array
    share: Array  # (n_pairs, n_joints) of strain energy
    squared_shape: Array  # (n_pairs, n_joints), unit modal mass
    damping: Array
    beside: Array  # phiᵀ C phi of what damps beside the joints
    posture: Array
    mac: Array


def fit_by_penalty(
    superset: Superset,
    structure: Structure,
    postures: tuple[MeasuredModes, ...],
    chosen: tuple[int, ...],
    *,
    added_mass_kg: tuple[Array, ...] | None = None,
) -> PenaltyFit:
    """Fit the chosen joints' stiffness by Eq. (13), all others kept.

    Parameters
    ----------
    structure
        Its joints' stiffnesses are where the search starts; axes and what is held stay.
    chosen
        Positions in `structure.joints`.
    added_mass_kg
        (n_points,) of every posture: the sensor's mass; none when omitted.

    Raises
    ------
    EstimateError
        If fewer modes are paired than joints chosen, or no paired mode strains a chosen joint.
    """
    masses = added_mass_kg or (np.zeros(len(superset.arm.points)),) * len(postures)
    free = np.array(chosen)
    for _ in range(ITERATIONS):
        pairs = _paired(superset, structure, postures, masses)
        _check(superset, structure, pairs, chosen)
        slope = 0.5 * pairs.f_model[:, None] * pairs.share[:, free]
        rest = pairs.f_measured - pairs.f_model
        step = np.clip(np.linalg.lstsq(slope, rest, rcond=None)[0], -LARGEST_STEP, LARGEST_STEP)
        k = structure.stiffness_n_m_per_rad.copy()
        k[free] *= np.exp(step)
        structure = replace(structure, stiffness_n_m_per_rad=k)
        if float(np.abs(step).max()) < CONVERGED:
            break
    else:
        raise EstimateError(
            f"the penalty of Eq. (13) did not settle in {ITERATIONS} steps: the shapes pair now "
            "one way, now another; measure more points, or choose fewer joints"
        )
    pairs = _paired(superset, structure, postures, masses)
    rest = pairs.f_measured - pairs.f_model
    structure = replace(structure, damping_n_m_s_per_rad=_damping(pairs))
    return PenaltyFit(
        chosen=chosen,
        structure=structure,
        k_std=_std(pairs, rest, free) * structure.stiffness_n_m_per_rad[free],
        penalty_hz2=float(rest @ rest),
        pairs=_rows(pairs, structure),
        left_out=sum(len(posture.modes) for posture in postures) - len(rest),
    )


def _paired(
    superset: Superset,
    structure: Structure,
    postures: tuple[MeasuredModes, ...],
    masses: tuple[Array, ...],
) -> _Pairs:
    k = structure.stiffness_n_m_per_rad
    rows: list[tuple[float, float, Array, Array, float, float, int, float]] = []
    dampers = structure.held_alone().dampers()
    for number, (posture, mass) in enumerate(zip(postures, masses, strict=True)):
        if not posture.modes:
            continue
        model = reduce_model(superset, posture.dynamics, structure, added_mass_kg=mass)
        squares, vectors = scipy.linalg.eigh(model.stiffness, model.mass)
        if squares[0] <= 0.0:
            raise EstimateError(
                "a stiffness fell so low that gravity topples the arm in a measured posture: "
                "Eq. (13) cannot tell the chosen joints; choose fewer"
            )
        shapes = posture.rows(model.point_jacobian) @ vectors
        for i, j, mac in pair_by_shape(posture.shapes, shapes):
            if mac < MIN_MAC:
                continue
            mode = posture.modes[i]
            f_model = float(np.sqrt(squares[j]) / (2 * np.pi))
            square = vectors[: len(k), j] ** 2
            beside = float(vectors[:, j] @ dampers @ vectors[:, j])
            share = k * square / squares[j]
            rows.append(
                (mode.f_hz, f_model, share, square, mode.damping_ratio, beside, number, mac)
            )
    columns = list(zip(*rows, strict=True)) or [()] * 8
    n = len(k)
    return _Pairs(
        f_measured=np.array(columns[0]),
        f_model=np.array(columns[1]),
        share=np.array(columns[2]).reshape(-1, n),
        squared_shape=np.array(columns[3]).reshape(-1, n),
        damping=np.array(columns[4]),
        beside=np.array(columns[5]),
        posture=np.array(columns[6], dtype=np.int64),
        mac=np.array(columns[7]),
    )


def _check(
    superset: Superset, structure: Structure, pairs: _Pairs, chosen: tuple[int, ...]
) -> None:
    names = [superset.arm.joints[structure.joints[i]].name for i in chosen]
    if len(pairs.f_measured) < len(chosen):
        raise EstimateError(
            f"wanted at least {len(chosen)} measured modes with the shape of a model mode for "
            f"{', '.join(names)}, got {len(pairs.f_measured)}; choose fewer joints or measure more "
            "postures"
        )
    for i, name in zip(chosen, names, strict=True):
        if pairs.share[:, i].max() < LEAST_SHARE:
            raise EstimateError(
                f"no measured mode strains {name} (at most {100 * pairs.share[:, i].max():.2g} % "
                "of a mode's energy): leave it out of the joints, or measure a posture that "
                "excites it"
            )


def _std(pairs: _Pairs, rest: Array, free: npt.NDArray[np.int64]) -> Array:
    """Standard deviation of ln k from the differences left over."""
    spare = len(rest) - len(free)
    if spare < 1:
        return np.full(len(free), np.nan)
    slope = 0.5 * pairs.f_model[:, None] * pairs.share[:, free]
    covariance = np.linalg.pinv(slope.T @ slope) * float(rest @ rest) / spare
    return np.asarray(np.sqrt(np.diag(covariance)))


def _damping(pairs: _Pairs) -> Array:
    """The c >= 0 whose phiᵀ C phi / (2 omega) is nearest to the measured damping ratios."""
    rows = pairs.squared_shape / (4 * np.pi * pairs.f_model[:, None])
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0.0] = 1.0
    own = pairs.damping - pairs.beside / (4 * np.pi * pairs.f_model)
    return np.asarray(scipy.optimize.nnls(rows / scale, own)[0] / scale)


def _rows(pairs: _Pairs, structure: Structure) -> tuple[PairedMode, ...]:
    modal = pairs.squared_shape @ structure.damping_n_m_s_per_rad + pairs.beside
    predicted = modal / (4 * np.pi * pairs.f_model)
    return tuple(
        PairedMode(
            posture=int(pairs.posture[i]),
            measured_hz=float(pairs.f_measured[i]),
            predicted_hz=float(pairs.f_model[i]),
            measured_damping=float(pairs.damping[i]),
            predicted_damping=float(predicted[i]),
            mac=float(pairs.mac[i]),
        )
        for i in range(len(pairs.f_model))
    )
