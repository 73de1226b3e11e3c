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
import scipy.linalg

from armodal.analyzer.planning.equations import Equations, PlannedArm
from armodal.analyzer.workspace.spectrum import ElasticJoints

__all__ = [
    "HitChoice",
    "PostureModes",
    "best_hits",
    "observable_joints",
    "observing_points",
    "posture_modes",
]

Array = npt.NDArray[np.float64]

_ANSWERS_HZ = 1000.0  # the hits of soft tips are over before anything slower has moved far
_WITHOUT_MASS = 1e-12  # 1/omega^2 over the lowest mode's: what moves no mass follows at once
_NORMAL = 2  # sensor z is the surface's normal
SEEN = 0.2  # of the largest motion: points that move less say little
EXCITED = 0.05  # of a hit's driving-point peaks: a mode that shows
APART = 3.0  # half-power half-widths between modes that do not hide each other
FAINT = 0.1  # of the mode's own peak: a neighbour that hides nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureModes:
    """Predicted modes of a posture, lowest first; k coordinates, n of them elastic joints."""

    f_hz: Array  # (m,)
    damping_ratio: Array  # (m,)
    shape: Array  # (k, m) unit modal mass
    joint_share: Array  # (n, m) of each mode's strain energy
    mass: Array  # (n, n) of the elastic joints

    def mode_of(self, joint: int) -> int:
        """The mode in which a joint has its largest share."""
        return int(np.argmax(self.joint_share[joint]))

    def effective_mass_kg(self, participation: Array) -> Array:
        """Mass (...) that a hit meets, from how much it moves each mode, (..., m)."""
        answers = self.f_hz < _ANSWERS_HZ
        give = np.sum(participation[..., answers] ** 2, axis=-1)
        return np.asarray(1.0 / np.maximum(give, 1e-12))


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


def posture_modes(own: Equations) -> PostureModes:
    """Modes of a posture without damping; damping and loss are taken to first order."""
    inverse_square, vectors = scipy.linalg.eigh(own.mass, own.spring)
    moves = inverse_square > _WITHOUT_MASS * inverse_square[-1]
    omega = 1.0 / np.sqrt(inverse_square[moves][::-1])  # lowest first
    shape = vectors[:, moves][:, ::-1] * omega
    energy = np.diag(own.spring)[:, None] * shape**2
    n = len(own.joint_gravity)
    lost = np.einsum("im,ij,jm->m", shape, own.damping, shape) / (2.0 * omega)
    lost += np.einsum("im,ij,jm->m", shape, own.loss, shape) / (2.0 * omega**2)
    return PostureModes(
        f_hz=omega / (2.0 * np.pi),
        damping_ratio=lost,
        shape=shape,
        joint_share=(energy / energy.sum(axis=0))[:n],
        mass=own.mass[:n, :n],
    )


def best_hits(
    planned: PlannedArm,
    own: Equations,
    modes: PostureModes,
    mode: int,
    *,
    least_mass_kg: float = 0.0,
) -> list[HitChoice]:
    """Hits at every moving point, each along the best of its sensor's axes; the best first.

    A hit is ranked by purity times its peak over the largest peak any hit gives; one that meets
    less than `least_mass_kg` comes last, since it drives the accelerometer out of its range.
    """
    choices = []
    for i in _moving(planned):
        axes = own.point_rotation[i]
        participation = axes.T @ own.point_linear[i] @ modes.shape  # (3 axes, modes)
        peaks = participation**2 / (2 * modes.damping_ratio)
        purity = peaks[:, mode] / np.maximum(peaks.sum(axis=1), 1e-300)
        mass = modes.effective_mass_kg(participation)
        merit = np.where(mass >= least_mass_kg, purity * peaks[:, mode], -1.0)
        axis = int(np.argmax(merit))
        choices.append(
            HitChoice(
                point=planned.arm.points[i].id,
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


def observing_points(
    planned: PlannedArm, own: Equations, modes: PostureModes, mode: int
) -> tuple[str, ...]:
    """Points that move at least a fifth as far in a mode as the one that moves most."""
    points = _moving(planned)
    motion = np.linalg.norm(own.point_linear[points] @ modes.shape[:, mode], axis=1)
    order = np.argsort(-motion)
    return tuple(
        planned.arm.points[points[i]].id for i in order if motion[i] >= SEEN * motion.max()
    )


def _moving(planned: PlannedArm) -> list[int]:
    return [i for i, link in enumerate(planned.superset.point_link) if link >= 0]


def observable_joints(
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
