"""How a joint turns under hits, and by torques of its own.

Both are known from the model's answers: to hits on lines s = sigma + j w, damped enough that a
short record holds them, to a torque where its steps ask for it (`steps.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.dynamic_stiffness import dynamic_stiffness, resists
from armodal.analyzer.gap.model.impulses import WIDTH_OF_SINE
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.system import System

__all__ = [
    "SIGMA_RAD_S",
    "Points",
    "Swings",
    "forces_of",
    "free_turns",
    "lines_below",
    "points",
    "pulse",
    "turns_of",
    "waves",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

# As near to the poles as the finest lines of a fit: what comes after the record counts nothing.
SIGMA_RAD_S = 4.0 * np.pi
_BAND_HZ = 500.0  # twice as far as the lines of a fit at most
_TAPER = 0.15  # of the band, cosine


@dataclass(frozen=True, slots=True, kw_only=True)
class Swings:
    """A joint in one posture, at the points of `turns_of`."""

    by_force: ComplexArray  # (n_hits, L) rad/N, of each hit, at those of them that are lines
    by_torque: ComplexArray  # (M,) rad/(N m), at all

    @property
    def by_steps(self) -> Array:
        """(n_steps, parts, parts) rad/(N m), by a torque in each part of a step (`Steps.of`)."""
        return STEPS.of(self.by_torque[points().steps])

    def stiffer(self, stiffness: float, damping: float, resists: ComplexArray) -> Swings:
        """Return the same with so much more in N m/rad and N m s/rad on the joint's spring.

        `resists` (M,) is what a unit of its stiffness resists by, losses with it.
        """
        more = stiffness * resists + damping * points().s_rad_s
        left = 1.0 / (1.0 + more * self.by_torque)
        return Swings(
            by_force=self.by_force * left[points().lines], by_torque=self.by_torque * left
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Points:
    """Where a posture is solved: rad/s, and which of them are for what."""

    s_rad_s: ComplexArray
    lines: slice  # of what comes before a torque
    steps: slice


@cache
def points() -> Points:
    """Return those of every posture."""
    lines = lines_below(_BAND_HZ)
    return Points(
        s_rad_s=np.concatenate([lines, STEPS.s_rad_s]),
        lines=slice(0, len(lines)),
        steps=slice(len(lines), None),
    )


def lines_below(band_hz: float) -> ComplexArray:
    """(L,) as far as anything of an arm answers; beyond, what is in time has nothing."""
    f_hz = np.arange(band_hz * STEPS.n * STEPS.step_s) / (STEPS.n * STEPS.step_s)
    return np.asarray(SIGMA_RAD_S + 2j * np.pi * f_hz)


def waves(n_lines: int) -> ComplexArray:
    """(parts n_steps, L) what each of `lines_below` is in time; the real part counts."""
    taper = np.ones(n_lines)
    ends = round(_TAPER * n_lines)
    taper[-ends:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(ends) + 0.5) / ends)
    taper[1:] *= 2.0  # of negative frequencies as well
    every = np.exp(np.outer(STEPS.seconds, lines_below(_BAND_HZ)[:n_lines]))
    return np.asarray(every * taper / (STEPS.n * STEPS.step_s))


def pulse(s_rad_s: ComplexArray, peak_n: float, width_s: float) -> ComplexArray:
    """Laplace transform of a half sine: of a hit with that peak, so wide at half of it."""
    length = WIDTH_OF_SINE * width_s
    b = np.pi / length
    return np.asarray(peak_n * b * (1.0 + np.exp(-s_rad_s * length)) / (s_rad_s**2 + b**2))


def turns_of(system: System, rows: Sequence[Array]) -> list[Swings]:
    """Turns of joints in one posture; the accelerometer's mass left out.

    Parameters
    ----------
    system
        Of one posture, stacked.
    rows
        (n,) by which each joint's spring stretches.
    """
    s = points().s_rad_s[None]
    soft = np.isfinite(system.compliance[0])
    gamma = np.where(soft, system.compliance, 1.0)[:, None]
    scale = np.where(soft, gamma / resists(system, s), 1.0)
    A = dynamic_stiffness(system, s)
    A *= scale[..., None]
    A[..., soft, soft] += 1.0
    answers = np.linalg.solve(A[0], scale[0][..., None] * np.transpose(rows))  # (M, n, k)
    forces = (system.force[0][:, None] @ system.hit[0])[:, 0]  # (n_hits, n)
    return [
        Swings(by_force=forces @ answer[points().lines].T, by_torque=answer @ row)
        for answer, row in zip(np.moveaxis(answers, 2, 0), rows, strict=True)
    ]


def free_turns(swings: Swings, hit: npt.NDArray[np.int64], forces: ComplexArray) -> Array:
    """(m, parts n_steps) turns in rad under hits with transforms (m, L), each at a place (m,)."""
    on_lines = swings.by_force[hit] * forces
    in_time = _in_time()
    return np.asarray(on_lines.real @ in_time.real - on_lines.imag @ in_time.imag)


@cache
def _in_time() -> ComplexArray:
    return waves(len(lines_below(_BAND_HZ))).T


def forces_of(peaks_n: Array, width_s: float) -> ComplexArray:
    """(m, L) transforms of half sines on the lines of `turns_of`."""
    s = points().s_rad_s[points().lines]
    return np.stack([pulse(s, float(peak), width_s) for peak in peaks_n])
