"""How a joint turns under hits while a torque of its own law acts on it, step by step in time.

With x_0 the turn that a linear model foretells and g the turn by a unit impulse of torque,

    x(t) = x_0(t) - int g(t - u) tau(x(u), ...) du ,

one equation however many coordinates the arm has. Both come from the model's answers on the lines
s = sigma + j w, damped enough that a short record holds them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import lost_by_power
from armodal.analyzer.gap.model.assembly import System
from armodal.analyzer.gap.model.dynamic_stiffness import dynamic_stiffness, resists
from armodal.analyzer.gap.model.impulses import WIDTH_OF_SINE
from armodal.analyzer.gap.model.joint_laws import Element

__all__ = [
    "SIGMA_RAD_S",
    "STEP_S",
    "Swings",
    "forces_of",
    "free_turns",
    "march",
    "pulse",
    "seconds",
    "turns_of",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

STEP_S, _STEPS = 5e-4, 1200
# As near to the poles as the finest lines of a fit: what comes after the record counts nothing.
SIGMA_RAD_S = 4.0 * np.pi
_BAND_HZ = 500.0  # twice as far as the lines of a fit at most
_TAPER = 0.15  # of the band, cosine
_BLOCK = 32
_NEWTON = 3
_ROUNDING = 1e-9  # of the largest turn: a step of the solution that changes nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class Swings:
    """A joint in one posture, on the lines of `turns_of`."""

    by_force: ComplexArray  # (n_hits, L) rad/N, of each hit
    by_torque: ComplexArray  # (L,) rad/(N m)

    @property
    def by_impulse(self) -> Array:
        """(n_steps,) rad/(N m s)."""
        return _in_time(self.by_torque)

    def stiffer(self, stiffness: float, damping: float, loss: float, power: float) -> Swings:
        """Return the same with so much more in N m/rad and N m s/rad on the joint's spring.

        `loss` is the factor by which its stiffness loses, growing with that power of frequency
        (`hysteresis.lost_by_power`).
        """
        s = _lines()
        more = stiffness * (1.0 + loss * lost_by_power(s, np.array(power))) + damping * s
        left = 1.0 / (1.0 + more * self.by_torque)
        return Swings(by_force=self.by_force * left, by_torque=self.by_torque * left)


def seconds() -> Array:
    """Return (n_steps,) time of every step."""
    return np.asarray(STEP_S * np.arange(_STEPS))


def _lines() -> ComplexArray:
    """(L,) as far as anything of an arm answers; beyond, what is in time has nothing."""
    f_hz = np.fft.rfftfreq(_STEPS, STEP_S)
    return np.asarray(SIGMA_RAD_S + 2j * np.pi * f_hz[f_hz < _BAND_HZ])


def _in_time(on_lines: ComplexArray) -> Array:
    """(..., n_steps) of (..., L)."""
    n = on_lines.shape[-1]
    taper = np.ones(n)
    ends = round(_TAPER * n)
    taper[-ends:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(ends) + 0.5) / ends)
    window = np.exp(SIGMA_RAD_S * seconds()) / STEP_S
    return np.asarray(np.fft.irfft(on_lines * taper, _STEPS) * window)


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
    s = _lines()[None]
    soft = np.isfinite(system.compliance[0])
    gamma = np.where(soft, system.compliance, 1.0)[:, None]
    scale = np.where(soft, gamma / resists(system, s), 1.0)
    A = dynamic_stiffness(system, s)
    A *= scale[..., None]
    A[..., soft, soft] += 1.0
    answers = np.linalg.solve(A[0], scale[0][..., None] * np.transpose(rows))  # (L, n, k)
    forces = (system.force[0][:, None] @ system.hit[0])[:, 0]  # (n_hits, n)
    return [
        Swings(by_force=forces @ answer.T, by_torque=answer @ row)
        for answer, row in zip(np.moveaxis(answers, 2, 0), rows, strict=True)
    ]


def free_turns(swings: Swings, hit: npt.NDArray[np.int64], forces: ComplexArray) -> Array:
    """(m, n_steps) turns in rad under hits with the transforms (m, L), each at a place (m,)."""
    return _in_time(swings.by_force[hit] * forces)


def forces_of(peaks_n: Array, width_s: float) -> ComplexArray:
    """(m, L) transforms of half sines on the lines of `turns_of`."""
    return np.stack([pulse(_lines(), float(peak), width_s) for peak in peaks_n])


def march(by_impulse: Array, groups: npt.NDArray[np.int64], free: Array, element: Element) -> Array:
    """Torque (n, n_steps) of an element in n swings.

    Parameters
    ----------
    by_impulse
        (P, n_steps) of every posture.
    groups
        (n,) posture of each swing, ascending.
    free
        (n, n_steps) turns without it.
    element
        Of n rows.
    """
    n, steps = free.shape
    torque = np.zeros((n, steps))
    memory = np.zeros((n, element.n_memory))
    of_row = STEP_S * by_impulse[groups]  # (n, n_steps)
    rows = [np.flatnonzero(groups == p) for p in range(len(by_impulse))]
    for begin in range(0, steps, _BLOCK):
        block = np.arange(begin, min(begin + _BLOCK, steps))
        coming = free[:, block].copy()
        if begin:
            ago = block[None, :] - np.arange(begin)[:, None]
            for own, g in zip(rows, by_impulse, strict=True):
                coming[own] -= STEP_S * (torque[own, :begin] @ g[ago])
        for i, at in enumerate(block):
            wanted = coming[:, i]
            if i:
                back = of_row[:, i:0:-1]
                wanted = wanted - np.einsum("ni,ni->n", torque[:, begin:at], back)
            x = wanted
            tau, slope = element.resist(x, memory)
            for _ in range(_NEWTON):
                step = (x - wanted + of_row[:, 0] * tau) / (1.0 + of_row[:, 0] * slope)
                x = x - step
                tau, slope = element.resist(x, memory)
                if np.abs(step).max() <= _ROUNDING * np.abs(x).max():
                    break
            torque[:, at] = tau
            memory = element.remember(x, memory, STEP_S)
    return torque
