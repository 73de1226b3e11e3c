"""Input shapers and notches: what they leave of a vibration, and how long they take.

A shaper is a few impulses that a command is convolved with. After the last of them a mode of
frequency omega and damping zeta is left with

    V = e^(-zeta omega t_n) | sum A_i e^(s t_i) | ,   s = zeta omega + j omega_d ,

of what the command alone leaves (Singer and Seering, J. Dyn. Syst. Meas. Control 112 (1990) 76,
Eq. (3)). Several modes take a shaper each, convolved (same, section 5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["KINDS", "Notch", "Shaper", "convolved", "notch", "shaper"]

Array = npt.NDArray[np.float64]

_TOLERATED = 0.05  # vibration that EI shapers allow at the modelled frequency, of the unshaped


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaper:
    """Impulses that sum to one."""

    amplitude: Array  # (n,)
    time_s: Array  # (n,) the first at zero

    @property
    def duration_s(self) -> float:
        """Return by how much a command becomes longer."""
        return float(self.time_s[-1])

    @property
    def delay_s(self) -> float:
        """Return by how much a slow command comes later: the mean of the times."""
        return float(self.amplitude @ self.time_s)

    def residual(self, f_hz: npt.ArrayLike, damping_ratio: npt.ArrayLike) -> Array:
        """Return what is left of modes, of what the unshaped command leaves."""
        omega = 2.0 * np.pi * np.asarray(f_hz, dtype=np.float64)
        zeta = np.asarray(damping_ratio, dtype=np.float64)
        s = omega * (zeta + 1j * np.sqrt(1.0 - zeta**2))
        # The last impulse counts without decay: no exponent grows.
        terms = self.amplitude * np.exp(
            s[..., None] * self.time_s - (zeta * omega)[..., None] * self.time_s[-1]
        )
        return np.asarray(np.abs(terms.sum(axis=-1)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Notch:
    """(s^2 + 2 z w s + w^2) / (s^2 + 2 p w s + w^2) with w = 2 pi f."""

    f_hz: float
    zero_damping: float  # z
    pole_damping: float  # p

    @property
    def delay_s(self) -> float:
        """Return the group delay of a slow command."""
        return (self.pole_damping - self.zero_damping) / (np.pi * self.f_hz)

    def residual(self, f_hz: npt.ArrayLike, damping_ratio: npt.ArrayLike) -> Array:
        """Return |N(s)| at the modes' poles: their residues are multiplied by it."""
        zeta = np.asarray(damping_ratio, dtype=np.float64)
        s = 2.0 * np.pi * np.asarray(f_hz) * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
        w = 2.0 * np.pi * self.f_hz
        above = s**2 + 2.0 * self.zero_damping * w * s + w**2
        below = s**2 + 2.0 * self.pole_damping * w * s + w**2
        return np.asarray(np.abs(above / below))


def shaper(kind: str, f_hz: float, damping_ratio: float) -> Shaper:
    """Return the shaper of a kind of `KINDS` for one mode."""
    root = float(np.sqrt(1.0 - damping_ratio**2))
    sizes, periods = KINDS[kind](damping_ratio / root)
    amplitude = np.array(sizes)
    return Shaper(amplitude=amplitude / amplitude.sum(), time_s=np.array(periods) / (f_hz * root))


def notch(f_hz: float, damping_ratio: float, pole_damping: float) -> Notch:
    """Return a notch whose zero is a mode's pole."""
    return Notch(f_hz=f_hz, zero_damping=damping_ratio, pole_damping=pole_damping)


def convolved(shapers: list[Shaper]) -> Shaper:
    """Return shapers one after the other."""
    amplitude, time = np.ones(1), np.zeros(1)
    for own in shapers:
        amplitude = np.outer(amplitude, own.amplitude).ravel()
        time = np.add.outer(time, own.time_s).ravel()
    order = np.argsort(time, kind="stable")
    return Shaper(amplitude=amplitude[order], time_s=time[order])


Impulses = tuple[list[float], list[float]]  # amplitudes, and times in damped periods


def _zv(decay: float) -> Impulses:
    """Zero vibration: Singer and Seering (1990), Eqs. (6) to (8)."""
    K = np.exp(-np.pi * decay)
    return [1.0, K], [0.0, 0.5]


def _mzv(decay: float) -> Impulses:
    """Zero vibration with three impulses in three quarters of a period; zero slope without damping.

    A_1 + A_2 e^(j 3 pi/4) + A_3 e^(j 3 pi/2) = 0 with A_1 = A_3: A_2 = sqrt(2) A_1; with damping
    each impulse is smaller by what the swing has died away until then.
    """
    K = np.exp(-0.75 * np.pi * decay)
    return [1.0, np.sqrt(2.0) * K, K**2], [0.0, 0.375, 0.75]


def _ei(decay: float) -> Impulses:
    """Extra-insensitive: Singhose, Seering and Singer, J. Mech. Des. 116 (1994) 654."""
    K = np.exp(-np.pi * decay)
    v = _TOLERATED
    return [(1.0 + v) / 4.0, (1.0 - v) / 2.0 * K, (1.0 + v) / 4.0 * K**2], [0.0, 0.5, 1.0]


def _two_hump(decay: float) -> Impulses:
    """Two-hump extra-insensitive: Singhose, Porter, Tuttle and Singer, JDSMC 119 (1997) 320."""
    K = np.exp(-np.pi * decay)
    v2 = _TOLERATED**2
    X = (v2 * (np.sqrt(1.0 - v2) + 1.0)) ** (1.0 / 3.0)
    a = (3.0 * X**2 + 2.0 * X + 3.0 * v2) / (16.0 * X)
    return [a, (0.5 - a) * K, (0.5 - a) * K**2, a * K**3], [0.0, 0.5, 1.0, 1.5]


KINDS: dict[str, Callable[[float], Impulses]] = {
    "zv": _zv,
    "mzv": _mzv,
    "ei": _ei,
    "2-hump": _two_hump,
}
