"""Equations of motion of a corrected arm in a posture, and how its points and its tool move.

    (s^2 M + s C + K + h(s) L + sum_j l_j(s) L_j) x = J' f ,  h(s) = (2/pi) ln(s / (2 pi 30 Hz)) ,

with L the stiffness times its loss factor (`docs/decisions/0007-loss-is-causal.md`). A
coordinate with a compliance gamma has the stiffness 1 / gamma and the damping tau / gamma. The
losses l_j of another law are those of a session's fit, whose drives' loss grows with a power of
frequency and has a part that relaxes (`analyzer.arm.hysteresis`); an arm file has none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import lost_by_power, relaxed
from armodal.analyzer.corrected.correction import Correction
from armodal.analyzer.corrected.cut_links import with_cut_links
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.geometry import PostureGeometry, skew
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.gap.model.systems import systems
from armodal.protocols.arm.records import Arm

__all__ = [
    "CorrectedPosture",
    "OtherLoss",
    "Stand",
    "assembly_at",
    "coordinate_names",
    "corrected_posture",
    "stand",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_LOCKED = 1e-11  # rad/(N m) or m/N: a millionth of what a joint gives way by


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherLoss:
    """A loss whose factor is not alike at all frequencies."""

    matrix: Array  # (n, n): stiffness times loss factor where that is told
    law: Callable[[ComplexArray], ComplexArray]  # of s (1, L), what a unit of it adds to K


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectedPosture:
    """n coordinates about rest; base frame, linear first."""

    names: tuple[str, ...]  # (n,) joints, then what effects let give way
    mass: Array  # (n, n)
    damping: Array  # (n, n)
    stiffness: Array  # (n, n), gravity's included
    loss: Array  # (n, n): stiffness times loss factor
    other_losses: tuple[OtherLoss, ...] = ()
    point_linear: Array  # (n_points, 3, n)
    tool_jacobian: Array  # (6, n) of the tool point
    tool_m: Array  # (3,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stand:
    """What a posture has that no effect's size changes."""

    angles_rad: Array  # (n_joints,) where the joints truly stand
    geometry: PostureGeometry
    T_base_last: Array  # (4, 4) of the last link


def stand(correction: Correction, joints_rad: npt.ArrayLike) -> Stand:
    """Evaluate an arm's geometry at (n_joints,) angles as the encoders read them.

    Raises
    ------
    ArmError
        If the number of angles is not the arm's or one is not finite.
    """
    superset = correction.ordinary.superset
    offset = correction.ordinary.encoder(correction.values)
    dynamics = superset.posture(np.asarray(joints_rad, dtype=np.float64) + offset)
    return Stand(
        angles_rad=dynamics.joints_rad,
        geometry=PostureGeometry(
            link_jacobian=dynamics.link_jacobian,
            point_jacobian=dynamics.point_jacobian,
            point_rotation=dynamics.point_rotation,
            gravity_per_mass=superset.gravity_stiffness_per_mass(dynamics.joints_rad),
            gravity_m_s2=dynamics.gravity_m_s2,
        ),
        T_base_last=dynamics.T_base_link[-1],
    )


def assembly_at(correction: Correction, at: Stand, *, level: float = 0.0) -> Assembly:
    """Put the equations together, coordinate by coordinate; `level` as `corrected_posture`."""
    ordinary, values = correction.ordinary, correction.values
    lines = _no_lines(ordinary.arm, at.angles_rad, level)
    (plain,) = ordinary.assemblies([at.geometry], [lines], values)
    return with_cut_links(correction.hypothesis.add_to(plain, values), ordinary.arm)


def corrected_posture(
    correction: Correction,
    at: Stand,
    *,
    level: float = 0.0,
    tool_m: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> CorrectedPosture:
    """Evaluate a posture.

    Parameters
    ----------
    level
        ln of the hits' peak force over the middle of the test's, for laws of amplitude.
    tool_m
        (3,) in the last link's frame.
    """
    assembly = assembly_at(correction, at, level=level)
    system = systems([assembly]).alone(0)
    gives = ~(system.compliance < _LOCKED)  # NaN: on a spring
    gamma = system.compliance[gives]
    springs = np.isnan(gamma)
    k = np.where(springs, 0.0, 1.0 / np.where(springs, 1.0, gamma))
    chosen = np.ix_(gives, gives)
    name_of = coordinate_names(assembly)
    R, p = at.T_base_last[:3, :3], at.T_base_last[:3, 3]
    local, tool = system.link_motion[-1][:, gives], np.asarray(tool_m, dtype=np.float64)
    linear = local[:3] - skew(tool) @ local[3:]
    grows = system.loss_power > 0.0
    alike = np.zeros_like(system.loss) if grows else system.loss
    return CorrectedPosture(
        names=tuple(name_of[column] for column in np.flatnonzero(gives)),
        mass=system.mass[chosen],
        damping=system.damping[chosen] + np.diag(k * system.compliance_loss_s[gives]),
        stiffness=system.stiffness[chosen] + np.diag(k),
        loss=alike[chosen] + np.diag(k * system.compliance_loss_factor[gives]),
        other_losses=_other_losses(system, chosen, grows=bool(grows)),
        point_linear=system.moved[..., gives],
        tool_jacobian=np.vstack([R @ linear, R @ local[3:]]),
        tool_m=R @ tool + p,
    )


def _other_losses(
    system: System, chosen: tuple[npt.NDArray[np.bool_], ...], *, grows: bool
) -> tuple[OtherLoss, ...]:
    """Losses of drives beside what is alike at all frequencies, those that are not zero."""
    laws: list[tuple[Array, Callable[[ComplexArray], ComplexArray]]] = []
    if grows:
        laws.append((system.loss, partial(lost_by_power, power=system.loss_power[None])))
    laws += [
        (matrix, partial(relaxed, rate_rad_s=rate[None]))
        for matrix, rate in zip(system.relaxing, system.relaxing_rad_s, strict=True)
    ]
    found = (OtherLoss(matrix=matrix[chosen], law=law) for matrix, law in laws)
    return tuple(loss for loss in found if loss.matrix.any())


def coordinate_names(assembly: Assembly) -> list[str]:
    """Return each coordinate's joint or parameter, numbered where one parameter has several."""
    found = dict.fromkeys(range(len(assembly.columns)), "")
    found |= {at: name for name, at in assembly.names.items()}
    for name, several in assembly.compliance_of.items():
        if len(several) > 1:
            found |= {at: f"{name} {i}" for i, (at, _) in enumerate(several, start=1)}
    return list(found.values())


def _no_lines(arm: Arm, angles: Array, level: float) -> PostureLines:
    """A posture without a measurement: every point is asked for, none is hit."""
    n = len(arm.points)
    return PostureLines(
        name="",
        joints_rad=angles,
        s_rad_s=np.zeros(0, dtype=np.complex128),
        sensor_point=np.arange(n),
        hit=np.zeros(n, dtype=np.int64),
        hit_point=np.zeros(0, dtype=np.int64),
        hit_direction=np.zeros((0, 3)),
        values=np.zeros((n, 3, 0), dtype=np.complex128),
        variance=np.zeros((n, 3, 0)),
        sensor_mass_kg=0.0,
        level=level,
    )
