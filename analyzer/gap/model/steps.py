"""Steps in which what happens in time is followed, and an answer's convolution in them.

Steps are those of Radau IIA with three stages, of fifth order: no torque gets more out of a joint
than it puts in, and one that sticks stays where it is, however stiff it is while it does.

References
----------
Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.5: Radau IIA.
Lubich and Ostermann, Math. Comp. 60 (1993) 105: convolution quadrature by Runge-Kutta methods.
C. Lubich, Numer. Math. 52 (1988) 413: the radius of its circle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["STEPS", "Steps"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_R = np.sqrt(6.0)
# How much of each stage counts at the end of each.
_A = np.array(
    [
        [(88.0 - 7.0 * _R) / 360.0, (296.0 - 169.0 * _R) / 1800.0, (3.0 * _R - 2.0) / 225.0],
        [(296.0 + 169.0 * _R) / 1800.0, (88.0 + 7.0 * _R) / 360.0, -(3.0 * _R + 2.0) / 225.0],
        [(16.0 - _R) / 36.0, (16.0 + _R) / 36.0, 1.0 / 9.0],
    ]
)


@dataclass(frozen=True)
class Steps:
    """So many steps, and so long."""

    n: int
    step_s: float
    parts = len(_A)  # of each, its stages

    @cached_property
    def seconds(self) -> Array:
        """(parts n,) when each part of a step ends."""
        ends = _A.sum(axis=1)
        return np.asarray((self.step_s * (np.arange(self.n)[:, None] + ends)).ravel())

    @cached_property
    def lasts_s(self) -> Array:
        """(parts,) seconds of each part of a step."""
        return np.diff(self.seconds[: self.parts], prepend=0.0)

    @cached_property
    def weights_s(self) -> Array:
        """(parts n,) weights of an integral over time."""
        return np.tile(self.step_s * _A[-1], self.n)

    @cached_property
    def _circle(self) -> tuple[Any, Any, float]:
        """Eigenvalues and vectors of the steps' differences on a circle, and its radius.

        What wraps around it is as small as rounding.
        """
        radius = float(np.finfo(float).eps ** (0.5 / self.n))
        z = radius * np.exp(-2j * np.pi * np.arange(self.n // 2 + 1) / self.n)
        before = np.ones((self.parts, 1)) * _A[-1]
        difference = np.linalg.inv(_A + (z / (1.0 - z))[:, None, None] * before)
        values, vectors = np.linalg.eig(difference)
        return np.asarray(values) / self.step_s, np.asarray(vectors), radius

    @cached_property
    def s_rad_s(self) -> ComplexArray:
        """(M,) where an answer has to be known."""
        return np.asarray(self._circle[0].ravel())

    def of(self, answer: ComplexArray) -> Array:
        """(n, parts, parts) an answer (M,) in steps.

        What a torque in each part (last) of a step does, so many steps later, in each part of one.
        """
        values, vectors, radius = self._circle
        turned = vectors * answer.reshape(values.shape)[:, None, :] @ np.linalg.inv(vectors)
        in_steps = np.fft.irfft(turned, self.n, axis=0)
        return np.asarray(in_steps / radius ** np.arange(self.n)[:, None, None])


# What is left after 0.6 s counts nothing.
STEPS = Steps(400, 1.5e-3)
