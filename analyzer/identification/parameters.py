"""The parameters of the model fit: logs of stiffness and damping, the axes, and the nuisances.

Positive quantities are fitted as logarithms, so that no step makes them negative and their
interval is multiplicative. An axis moves in the tangent of its present line. Nuisances are what
the laboratory knows only roughly; each has the arm file's tolerance as its prior.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.structure import Axis, Structure
from armodal.analyzer.screws.cross import across
from armodal.protocols.arm.records import Arm, Tolerances

__all__ = ["FitState", "ParameterNames", "step_state"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitState:
    """Everything the fit may change, at one iterate."""

    structure: Structure
    log_gain: Array  # (3,) of the accelerometer's axes over the hammer's gain
    hit_tilt_rad: Array  # (n_postures, 2) of the force's direction about its planned one


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterNames:
    """Order and prior of the parameters of a fit.

    Order: ln k of joints, ln c of joints; per axis two tilts of its direction, two shifts of its
    point, ln k, ln c; three log gains; two tilts of the hit in each posture.
    """

    names: tuple[str, ...]
    prior_std: Array  # (n,), inf where the data alone speak

    @classmethod
    def of(cls, arm: Arm, structure: Structure, postures: tuple[str, ...]) -> ParameterNames:
        """Name the parameters of a structure on some postures and give them their priors."""
        joints = [arm.joints[i].name for i in structure.joints]
        names = [f"ln k {joint}" for joint in joints] + [f"ln c {joint}" for joint in joints]
        prior = [np.inf] * len(names)
        for i in range(len(structure.axes)):
            parts = ("tilt a", "tilt b", "shift a", "shift b", "ln k", "ln c")
            names += [f"{part} axis {i + 1}" for part in parts]
            prior += [np.inf] * len(parts)
        tolerances = arm.tolerances
        names += [f"ln gain {axis}" for axis in "xyz"]
        prior += [_gain_std(tolerances)] * 3
        for posture in postures:
            names += [f"hit tilt {side} {posture}" for side in "ab"]
            prior += [tolerances.hit_direction_rad] * 2
        return cls(names=tuple(names), prior_std=np.array(prior))


def _gain_std(tolerances: Tolerances) -> float:
    return float(np.hypot(tolerances.sensor_gain, tolerances.hammer_gain))


def step_state(state: FitState, step: Array) -> FitState:
    """Move a state by a step of the parameters, in the order of `ParameterNames`."""
    structure = state.structure
    n = len(structure.joints)
    axes: list[Axis] = []
    at = 2 * n
    for axis in structure.axes:
        tilt, shift = step[at : at + 2], step[at + 2 : at + 4]
        frame = across(axis.direction)
        direction = axis.direction + frame @ tilt
        direction = direction / np.linalg.norm(direction)
        point = axis.point_m + frame @ shift
        axes.append(
            replace(
                axis,
                direction=direction,
                point_m=point - direction * (direction @ point),
                stiffness_n_m_per_rad=axis.stiffness_n_m_per_rad * float(np.exp(step[at + 4])),
                damping_n_m_s_per_rad=axis.damping_n_m_s_per_rad * float(np.exp(step[at + 5])),
            )
        )
        at += 6
    return FitState(
        structure=replace(
            structure,
            stiffness_n_m_per_rad=structure.stiffness_n_m_per_rad * np.exp(step[:n]),
            damping_n_m_s_per_rad=structure.damping_n_m_s_per_rad * np.exp(step[n : 2 * n]),
            axes=tuple(axes),
        ),
        log_gain=state.log_gain + step[at : at + 3],
        hit_tilt_rad=state.hit_tilt_rad + step[at + 3 :].reshape(-1, 2),
    )


def parameter_vector(state: FitState) -> Array:
    """Return the prior-bearing part of the state as offsets from the priors' means, else 0."""
    n_free = 2 * len(state.structure.joints) + 6 * len(state.structure.axes)
    return np.concatenate([np.zeros(n_free), state.log_gain, state.hit_tilt_rad.ravel()])
