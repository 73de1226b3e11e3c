"""The structure on its lowest modes, and its answer on lines of the Laplace plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.frame.standing import Standing
from armodal.hil_sim.makers.frame.structure import Complex, Law

__all__ = ["GRAVITY_M_S2", "Modal", "loss_law", "modal"]

GRAVITY_M_S2 = np.array([0.0, 0.0, -9.80665])
HIGHEST_HZ = 1500.0  # of the modes kept; the band ends at a third of it
LOSS_FROM_RAD_S = 1.0  # where Biot's law begins to lose


@dataclass(frozen=True, slots=True, kw_only=True)
class Modal:
    """Modes of unit modal mass and what damps them."""

    frequencies_hz: Array  # (m,) of all modes kept
    shapes: Array  # (n, m)
    lost: Array  # (m, m) sum of loss factors times stiffness
    laws: tuple[tuple[Array, Law], ...]  # (m,) vectors

    def receptance(self, s: Complex, left: Array, right: Array) -> Complex:
        """Answer along rows `left`, (k, n), to loads `right`, (n, l), over lines: (lines, k, l)."""
        m = len(self.frequencies_hz)
        Z = np.zeros((len(s), m, m), dtype=np.complex128)
        diagonal = np.arange(m)
        squared = (2.0 * np.pi * self.frequencies_hz) ** 2
        Z[:, diagonal, diagonal] = (s**2)[:, None] + squared
        Z += loss_law(s)[:, None, None] * self.lost
        for vector, law in self.laws:
            Z += law(s)[:, None, None] * np.outer(vector, vector)
        loads = np.broadcast_to(self.shapes.T @ right, (len(s), m, right.shape[1]))
        moved = np.linalg.solve(Z, loads)
        return np.asarray((left @ self.shapes) @ moved, dtype=np.complex128)


def loss_law(s: Complex) -> Complex:
    """Biot's nearly constant hysteresis: causal, of loss factor one well above its first line.

    Biot, Proc. 3rd US Nat. Congr. Appl. Mech. (1958) 1: (2 / pi) ln(1 + s / epsilon).
    """
    return np.asarray((2.0 / np.pi) * np.log(1.0 + s / LOSS_FROM_RAD_S), dtype=np.complex128)


def modal(standing: Standing, highest_hz: float = HIGHEST_HZ) -> Modal:
    """Solve the undamped eigenproblem under gravity, and keep the modes below a frequency.

    As M v = K v / omega^2: rounding spoils the smallest eigenvalues of a stiff shell's matrices,
    and so they are those of the highest modes.
    """
    structure = standing.structure
    K, lost = structure.stiffness()
    K += structure.under_load(GRAVITY_M_S2)
    M = structure.mass()
    inverse, shapes = linalg.eigh(M, K)
    kept = inverse > (2.0 * np.pi * highest_hz) ** -2
    inverse, shapes = inverse[kept][::-1], shapes[:, kept][:, ::-1]
    shapes = shapes / np.sqrt(inverse)
    return Modal(
        frequencies_hz=1.0 / (2.0 * np.pi * np.sqrt(inverse)),
        shapes=shapes,
        lost=shapes.T @ lost @ shapes,
        laws=tuple((shapes.T @ vector, law) for vector, law in structure.laws),
    )
