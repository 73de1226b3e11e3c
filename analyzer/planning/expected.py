"""How well a set of tests would tell the stiffnesses: the standard deviation to expect.

The accelerance H = s² o Z⁻¹ b of every hit and point, on lines from `low_hz` to `high_hz`, is known
to the accelerometer's noise over the hammer's spectrum; a mounting mixes its three axes by about a
hundredth, the same on every line. The Fisher information of ln k and ln c together gives the
smallest standard deviation that tests of this size can have (Cramér and Rao).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import hysteresis
from armodal.analyzer.planning.equations import Equations, PlannedArm

__all__ = ["Instruments", "expected_std", "information"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Instruments:
    """What the measurement is made with."""

    low_hz: float = 4.0
    line_hz: float = 0.5
    high_hz: float = 200.0
    impulse_n_s: float = 0.15  # of a hit
    acceleration_noise: float = 2e-3  # m/s²/sqrt(Hz), one-sided
    hits: int = 3
    force_peak_n: float = 20.0  # of a hit well above the hammer's noise
    acceleration_range: float = 100.0  # m/s² the accelerometer takes
    mounting: float = 0.01  # tilt of a mounting and aim of its hits, in parts of the motion

    @property
    def least_mass_kg(self) -> float:
        """Mass a hit has to meet so that the accelerometer stays within its range."""
        return self.force_peak_n / self.acceleration_range


def information(
    planned: PlannedArm,
    own: Equations,
    *,
    hit_point: str,
    hit_direction: Array,
    points: tuple[str, ...],
    instruments: Instruments,
) -> Array:
    """Fisher information (2n, 2n) of (ln k, ln c) from one test; n coordinates, joints first.

    What effects let give way is fitted beside the joints: its spring and damper are unknown too.
    """
    index = planned.superset.point_index
    b = own.point_linear[index[hit_point]].T @ hit_direction
    o = own.point_linear[[index[point] for point in points]].reshape(-1, len(b))
    f_hz = np.arange(instruments.low_hz, instruments.high_hz, instruments.line_hz)
    s = 2j * np.pi * f_hz
    elastic, n = planned.elastic, len(planned.elastic.joints)
    k = np.append(elastic.stiffness_n_m_per_rad, np.diag(own.spring)[n:])
    c = np.append(elastic.damping_n_m_s_per_rad, np.diag(own.damping)[n:])
    K = own.spring + own.gravity + hysteresis(s)[:, None, None] * own.loss
    Z = (s**2)[:, None, None] * own.mass + s[:, None, None] * own.damping + K
    X = np.linalg.solve(Z, np.broadcast_to(b[:, None], (len(s), len(b), 1)))[..., 0]
    Y = np.linalg.solve(Z, np.broadcast_to(o.T, (len(s), *o.T.shape)))  # (lines, n, rows)
    square = (s**2)[:, None]
    H = square * (X @ o.T)  # (lines, rows)
    by_k = -square[..., None] * np.einsum("lnr,ln,n->lrn", Y, X, k)
    by_c = -(square * s[:, None])[..., None] * np.einsum("lnr,ln,n->lrn", Y, X, c)
    # One hit of impulse p has the spectrum p below the tip's cut-off. White noise x of the
    # one-sided density d over a record of T seconds: E|∫ x e^(-st) dt|² = d² T / 2 on a line, half
    # of it in the real and half in the imaginary part (Bendat and Piersol, Random Data, 4th ed.
    # 2010, ch. 5).
    noise = instruments.acceleration_noise / (2.0 * np.sqrt(instruments.line_hz))
    noise /= instruments.impulse_n_s
    weight = np.sqrt(instruments.hits) / noise
    slope = _real(weight * np.concatenate([by_k, by_c], axis=2), len(points))
    motion = weight * H.reshape(len(s), len(points), 3)
    total = np.zeros((slope.shape[-1],) * 2)
    for i, of_point in enumerate(slope):
        # A mounting mixes its axes by a small matrix: nine numbers, marginalised with their prior.
        mixed = np.einsum("ab,lc->labc", np.eye(3), motion[:, i]).reshape(len(s), 3, 9)
        mixing = _real(mixed, 1)[0]
        cross = of_point.T @ mixing
        prior = np.eye(9) / instruments.mounting**2
        total += of_point.T @ of_point - cross @ np.linalg.solve(mixing.T @ mixing + prior, cross.T)
    return total


def _real(values: npt.NDArray[np.complexfloating[Any, Any]], n_points: int) -> Array:
    """Real and imaginary parts as rows: (lines, 3 n_points, n) to (n_points, 6 lines, n)."""
    lines, _, n = values.shape
    by_point = values.reshape(lines, n_points, 3, n).transpose(1, 0, 2, 3).reshape(n_points, -1, n)
    return np.concatenate([by_point.real, by_point.imag], axis=1)


def expected_std(informations: list[Array], n_joints: int) -> Array:
    """Relative standard deviation of joints' k, (n_joints,), from the information of several tests.

    A joint that no test tells about has an infinite one.
    """
    total = np.sum(informations, axis=0)
    scale = np.sqrt(np.diag(total))
    known = scale > 0
    std = np.full(len(total), np.inf)
    inner = total[np.ix_(known, known)] / np.outer(scale[known], scale[known])
    std[known] = np.sqrt(np.diag(np.linalg.pinv(inner, hermitian=True))) / scale[known]
    return std[:n_joints]
