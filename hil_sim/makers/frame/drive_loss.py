"""How a drive loses: a dashpot for most of it, and relaxations spread evenly over a band of rates.

A relaxation at w, a spring in series with a damper, gives way below w and is a spring above it. As
many of them in every part of an octave between two rates, and none outside, add

    k d ln((1 + s/a) / (1 + s/b)) / ln(b/a)

to a drive of stiffness k at rest: k d where it moves fast (Fung, Biomechanics (1981), section 7.6:
a spectrum of c / tau between two times).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from armodal.hil_sim.makers.frame.structure import Complex, Law

__all__ = ["LOSS_AT_HZ", "DriveLoss"]

LOSS_AT_HZ = 15.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveLoss:
    """A dashpot's loss factor at `LOSS_AT_HZ`, and by how much the drive is stiffer when fast."""

    factor: float
    stiffer: float = 0.0  # than at rest, of its stiffness there
    band_hz: tuple[float, float] = (1.0, 2.0)  # where it becomes so

    def law(self, stiffness: float, more: float = 1.0) -> Law:
        """Return what a drive adds to its stiffness at rest, its dashpot multiplied by `more`."""
        dashpot = stiffness * self.factor * more / (2.0 * np.pi * LOSS_AT_HZ)
        slow, fast = (2.0 * np.pi * f_hz for f_hz in self.band_hz)
        grown = stiffness * self.stiffer / np.log(fast / slow)

        def law(s: Complex) -> Complex:
            relaxed: Complex = np.log1p(s / slow) - np.log1p(s / fast)
            return np.asarray(dashpot * s + grown * relaxed)

        return law
