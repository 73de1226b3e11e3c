"""How a drive loses: a dashpot for most of it, and Maxwell elements that relax at rates of theirs.

A Maxwell element, a spring k d in series with a damper, adds k d s / (s + w) and loses most at w;
below w it gives way, above it is a spring.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from armodal.hil_sim.makers.frame.structure import Complex, Law

__all__ = ["LOSS_AT_HZ", "DriveLoss"]

LOSS_AT_HZ = 15.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveLoss:
    """A loss factor at `LOSS_AT_HZ`, and what Maxwell elements have of it."""

    factor: float
    relaxing: tuple[tuple[float, float], ...] = ()  # part of the loss, and where it is most, Hz

    def law(self, stiffness: float, more: float = 1.0) -> Law:
        """Return what a drive adds to its stiffness at rest, its loss multiplied by `more`."""
        omega = 2.0 * np.pi * LOSS_AT_HZ
        lost = stiffness * self.factor * more
        dashpot = lost * (1.0 - sum(part for part, _ in self.relaxing)) / omega
        springs = [
            (lost * part * (LOSS_AT_HZ / f_hz + f_hz / LOSS_AT_HZ), 2.0 * np.pi * f_hz)
            for part, f_hz in self.relaxing
        ]

        def law(s: Complex) -> Complex:
            result: Complex = dashpot * s
            for spring, rate in springs:
                result = result + spring * s / (s + rate)
            return result

        return law
