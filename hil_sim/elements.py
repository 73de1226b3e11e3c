"""Torques that are no linear function of the motion, each along one row of the coordinates.

An element resists the stretch s = row @ q by g(s) on top of the linear terms. What it remembers
(where its sliders stand) is an array with one row a hit, so that many hits run at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

__all__ = ["Element", "Gap", "OneSided", "Sliders", "Softening"]

Array = npt.NDArray[np.float64]


class Element(Protocol):
    """What every element can do; s is (n_hits,)."""

    @property
    def row(self) -> Array:
        """(n,) row of the coordinates."""
        ...

    @property
    def n_memory(self) -> int:
        """Numbers remembered."""
        ...

    def resist(self, s: Array, memory: Array) -> tuple[Array, Array]:
        """Torque and its slope, (n_hits,) each."""
        ...

    def remember(self, s: Array, memory: Array) -> Array:
        """(n_hits, n_memory) once the step to s is done."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class _Forgetful:
    row: Array

    @property
    def n_memory(self) -> int:
        """None."""
        return 0

    def remember(self, s: Array, memory: Array) -> Array:
        """Return the memory as it is."""
        del s
        return memory


@dataclass(frozen=True, slots=True, kw_only=True)
class OneSided(_Forgetful):
    """Beyond `opening` the stiffness is less by `lost`."""

    lost: float
    opening: float

    def resist(self, s: Array, memory: Array) -> tuple[Array, Array]:
        """Nothing while closed."""
        del memory
        beyond = s - self.opening
        slope = np.where(beyond > 0.0, -self.lost, 0.0)
        return slope * beyond, slope


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap(_Forgetful):
    """A spring k with play: no torque over `2 half`, at rest under a load.

    The linear terms hold the spring without play. With x the spring's own stretch, k (|x| - half)
    outside the play and nothing inside; at rest it carries `load`, so x = s + load / k + half by
    the load's sign, or s where there is no load.
    """

    k: float
    half: float
    load: float

    def resist(self, s: Array, memory: Array) -> tuple[Array, Array]:
        """What the play takes from the linear spring."""
        del memory
        x = s + self.load / self.k + self.half * np.sign(self.load)
        inside = np.abs(x) < self.half
        torque = self.k * (x - np.clip(x, -self.half, self.half)) - self.load - self.k * s
        return torque, np.where(inside, -self.k, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Softening(_Forgetful):
    """A part of the spring's stiffness `soft` that saturates about a stretch `at`.

    g = soft (at tanh(s / at) - s): small motion is the linear spring's, large motion loses `soft`.
    """

    soft: float
    at: float

    def resist(self, s: Array, memory: Array) -> tuple[Array, Array]:
        """Loss of torque at large stretch."""
        del memory
        bent = np.tanh(s / self.at)
        return self.soft * (self.at * bent - s), -self.soft * bent**2


@dataclass(frozen=True, slots=True, kw_only=True)
class Sliders:
    """Springs in series with dry friction, side by side: Jenkins elements.

    W. D. Iwan, J. Appl. Mech. 33 (1966) 893. One stiff element is Coulomb friction; several with
    staggered limits slip a little at any amplitude (microslip).
    """

    row: Array
    k: Array  # (n,) of each spring
    limit: Array  # (n,) at which it slips

    @property
    def n_memory(self) -> int:
        """One place a slider."""
        return len(self.k)

    def resist(self, s: Array, memory: Array) -> tuple[Array, Array]:
        """Sum of the springs' torques, none above its limit."""
        wanted = self.k * (s[:, None] - memory)
        sticks = np.abs(wanted) < self.limit
        torque = np.clip(wanted, -self.limit, self.limit).sum(axis=1)
        return torque, (sticks * self.k).sum(axis=1)

    def remember(self, s: Array, memory: Array) -> Array:
        """Sliders follow what pulls them beyond their limit."""
        reach = self.limit / self.k
        return np.clip(memory, s[:, None] - reach, s[:, None] + reach)
