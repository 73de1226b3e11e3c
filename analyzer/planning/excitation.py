"""Where and along what to hit so that one joint's mode answers, and which points see it.

A mode of unit modal mass answers a unit force at its resonance with an accelerance of
|phiᵀ b| |o phi| / (2 zeta) (file 002, Eq. 6, one degree of freedom at resonance), b and o the
columns of the hit's and the sensor's Jacobians. The driving-point peak |phiᵀ b|² / (2 zeta) of the
wanted mode is set against those of all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.workspace.spectrum import ElasticJoints, spectrum_of_mass

__all__ = [
    "HitChoice",
    "PostureModes",
    "best_hits",
    "joints_shown",
    "posture_modes",
    "seeing_points",
]

Array = npt.NDArray[np.float64]

_NORMAL = 2  # sensor z is the surface's normal
SEEN = 0.2  # of the largest motion: points that move less say little
EXCITED = 0.05  # of a hit's driving-point peaks: a mode that shows
APART = 3.0  # half-power half-widths between modes that do not hide each other
FAINT = 0.1  # of the mode's own peak: a neighbour that hides nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureModes:
    """Predicted modes of a posture; n elastic joints, as many modes."""

    f_hz: Array  # (n,)
    damping_ratio: Array  # (n,)
    shape: Array  # (n, n) unit modal mass
    joint_share: Array  # (n joints, n modes) of each mode's strain energy
    mass: Array  # (n, n) of the elastic joints

    def mode_of(self, joint: int) -> int:
        """The mode in which a joint has its largest share."""
        return int(np.argmax(self.joint_share[joint]))


@dataclass(frozen=True, slots=True, kw_only=True)
class HitChoice:
    """A hit that excites a mode."""

    point: str
    direction_base: Array  # (3,) unit
    peak: float  # driving-point accelerance of the wanted mode at its resonance, m/(s² N)
    purity: float  # that peak over the sum of all modes' peaks
    share: Array  # (n_modes,) of each mode in that sum
    effective_mass_kg: float  # that the hammer meets: a force F gives the acceleration F / m
    along_normal: bool  # the surface itself takes the hit; else it needs a block to hit sideways


def posture_modes(
    superset: Superset, dynamics: PostureDynamics, elastic: ElasticJoints
) -> PostureModes:
    """Modes of a posture, springs only."""
    columns = [superset.joint_column(joint) for joint in elastic.joints]
    mass = dynamics.mass[np.ix_(columns, columns)]
    found = spectrum_of_mass(
        mass[..., None],
        ElasticJoints(
            joints=tuple(range(len(columns))),
            stiffness_n_m_per_rad=elastic.stiffness_n_m_per_rad,
            damping_n_m_s_per_rad=elastic.damping_n_m_s_per_rad,
        ),
    )
    shape = found.shape[0]
    energy = elastic.stiffness_n_m_per_rad[:, None] * shape**2
    return PostureModes(
        f_hz=found.f_hz[0],
        damping_ratio=found.damping_ratio[0],
        shape=shape,
        joint_share=energy / energy.sum(axis=0),
        mass=mass,
    )


def best_hits(
    superset: Superset,
    dynamics: PostureDynamics,
    elastic: ElasticJoints,
    modes: PostureModes,
    mode: int,
    *,
    least_mass_kg: float = 0.0,
) -> list[HitChoice]:
    """Hits at every moving point, each along the best of its sensor's axes; the best first.

    A hit is ranked by purity times its peak over the largest peak any hit gives; one that meets
    less than `least_mass_kg` comes last, since it drives the accelerometer out of its range.
    """
    J, points = _elastic_jacobian(superset, dynamics, elastic)
    flexibility = np.linalg.inv(modes.mass)
    choices = []
    for i in points:
        axes = dynamics.point_rotation[i]
        participation = axes.T @ J[i] @ modes.shape  # (3 axes, modes)
        peaks = participation**2 / (2 * modes.damping_ratio)
        purity = peaks[:, mode] / np.maximum(peaks.sum(axis=1), 1e-300)
        along = axes.T @ J[i]
        mass = 1.0 / np.maximum(np.einsum("an,nm,am->a", along, flexibility, along), 1e-12)
        merit = np.where(mass >= least_mass_kg, purity * peaks[:, mode], -1.0)
        axis = int(np.argmax(merit))
        choices.append(
            HitChoice(
                point=superset.arm.points[i].id,
                direction_base=axes[:, axis],
                peak=float(peaks[axis, mode]),
                purity=float(purity[axis]),
                share=peaks[axis] / max(float(peaks[axis].sum()), 1e-300),
                effective_mass_kg=float(mass[axis]),
                along_normal=axis == _NORMAL,
            )
        )
    largest = max((choice.peak for choice in choices), default=1.0)

    def merit_of(choice: HitChoice) -> tuple[bool, float]:
        gentle = choice.effective_mass_kg >= least_mass_kg
        return gentle, choice.purity * choice.peak / largest

    return sorted(choices, key=merit_of, reverse=True)


def seeing_points(
    superset: Superset,
    dynamics: PostureDynamics,
    elastic: ElasticJoints,
    modes: PostureModes,
    mode: int,
) -> tuple[str, ...]:
    """Points that move at least a fifth as far in a mode as the one that moves most."""
    J, points = _elastic_jacobian(superset, dynamics, elastic)
    motion = np.linalg.norm(J[points] @ modes.shape[:, mode], axis=1)
    order = np.argsort(-motion)
    return tuple(
        superset.arm.points[points[i]].id for i in order if motion[i] >= SEEN * motion.max()
    )


def _elastic_jacobian(
    superset: Superset, dynamics: PostureDynamics, elastic: ElasticJoints
) -> tuple[Array, list[int]]:
    columns = [superset.joint_column(joint) for joint in elastic.joints]
    moving = [i for i, link in enumerate(superset.point_link) if link >= 0]
    return dynamics.point_jacobian[:, :3][:, :, columns], moving


def joints_shown(
    elastic: ElasticJoints, modes: PostureModes, joints: Sequence[int], hit: HitChoice
) -> tuple[int, ...]:
    """Of some joints, those whose own mode a hit excites and no other excited mode hides.

    `joints` are 0-based among the arm's, all of them elastic.
    """
    half_width = modes.damping_ratio * modes.f_hz
    shown = []
    for joint in joints:
        mode = modes.mode_of(elastic.joints.index(joint))
        apart = np.abs(modes.f_hz - modes.f_hz[mode]) > APART * (half_width + half_width[mode])
        hidden = ~apart & (hit.share > FAINT * hit.share[mode])
        hidden[mode] = False
        if hit.share[mode] >= EXCITED and not hidden.any():
            shown.append(joint)
    return tuple(shown)
