"""Modes of a corrected arm in a posture: poles of its equations, loss by hysteresis included."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.arm.hysteresis import hysteresis
from armodal.analyzer.corrected.posture import CorrectedPosture, OtherLoss
from armodal.protocols.errors import EstimateError

__all__ = ["CorrectedModes", "corrected_modes"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_CLOSE = 1e-10  # relative change of a pole
_MOST_STEPS = 50
_WITHOUT_MASS = 1e-12  # 1/omega^2 over the lowest mode's: what moves no mass follows at once
_SWINGS = 1e-9  # imaginary part of a pole over its size; less is rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectedModes:
    """Modes that oscillate, lowest frequency first."""

    pole_rad_s: ComplexArray  # (m,)
    shape: ComplexArray  # (n, m), modal mass phi' M phi one

    @property
    def f_hz(self) -> Array:
        """Return (m,) |pole| / 2 pi."""
        return np.abs(self.pole_rad_s) / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> Array:
        """Return (m,)."""
        return np.asarray(-self.pole_rad_s.real / np.abs(self.pole_rad_s))


def corrected_modes(
    posture: CorrectedPosture, *, n_modes: int | None = None, below_hz: float = np.inf
) -> CorrectedModes:
    """Poles and shapes of a posture: the lowest `n_modes` of those below a frequency.

    Without a loss factor the poles are eigenvalues of the state matrix (Ewins, Modal Testing, 2nd
    ed. (2000), Eq. (2.91)). With one the equations are solved with each pole's own losses, again
    and again until it stays where it is.

    Raises
    ------
    EstimateError
        If nothing oscillates, the arm falls, or a pole does not settle.
    """
    own = _in_modes(posture)
    poles, vectors = _solved(own, np.zeros_like(own.damping))
    if not poles.size:
        raise EstimateError(
            "no mode of the arm oscillates in this posture; check stiffness and damping in its file"
        )
    heard = np.flatnonzero(np.abs(poles) < 2.0 * np.pi * below_hz)[:n_modes]
    poles, vectors = poles[heard], vectors[:, heard]
    if (own.loss.any() or own.other_losses) and poles.size:
        found = [_settled(own, *mode) for mode in zip(poles, vectors.T, strict=True)]
        poles = np.array([pole for pole, _ in found])
        vectors = np.stack([shape for _, shape in found], axis=1)
        order = np.argsort(np.abs(poles))
        poles, vectors = poles[order], vectors[:, order]
    shape = own.shape @ vectors
    return CorrectedModes(pole_rad_s=poles, shape=_of_unit_mass(shape, posture.mass))


@dataclass(frozen=True, slots=True, kw_only=True)
class _InModes:
    """Equations in the coordinates of the undamped modes, of unit modal mass."""

    omega_rad_s: Array  # (m,)
    damping: Array  # (m, m)
    loss: Array  # (m, m)
    other_losses: tuple[OtherLoss, ...]
    shape: Array  # (n, m)

    def adds(self, s: complex) -> ComplexArray:
        """Return (m, m) what all losses add to the stiffness at s."""
        at = np.array([[s]])
        added = hysteresis(at)[0, 0] * self.loss
        for other in self.other_losses:
            added = added + other.law(at)[0, 0] * other.matrix
        return np.asarray(added)


def _in_modes(posture: CorrectedPosture) -> _InModes:
    if scipy.linalg.eigvalsh(posture.stiffness)[0] <= 0.0:
        raise EstimateError(
            "the arm's springs do not hold it against gravity in this posture; check every "
            "stiffness in its file"
        )
    inverse_square, shape = scipy.linalg.eigh(posture.mass, posture.stiffness)
    moves = inverse_square > _WITHOUT_MASS * inverse_square[-1]
    omega = 1.0 / np.sqrt(inverse_square[moves])
    shape = shape[:, moves] * omega
    return _InModes(
        omega_rad_s=omega,
        damping=shape.T @ posture.damping @ shape,
        loss=shape.T @ posture.loss @ shape,
        other_losses=tuple(
            replace(other, matrix=shape.T @ other.matrix @ shape) for other in posture.other_losses
        ),
        shape=shape,
    )


def _settled(own: _InModes, pole: complex, shape: ComplexArray) -> tuple[complex, ComplexArray]:
    """Pole and shape of the mode that has this shape: frequencies may pass each other."""
    for _ in range(_MOST_STEPS):
        poles, vectors = _solved(own, own.adds(pole))
        alike = np.abs(shape.conj() @ vectors) / np.linalg.norm(vectors, axis=0)
        at = int(np.argmax(alike))
        before, pole, shape = pole, complex(poles[at]), vectors[:, at]
        if abs(pole - before) < _CLOSE * abs(pole):
            return pole, shape
    raise EstimateError(
        f"the mode near {abs(pole) / (2.0 * np.pi):.1f} Hz does not settle with the arm's loss "
        "factors; check them in its [[effects]]"
    )


def _solved(
    own: _InModes, added: npt.NDArray[np.inexact[Any]]
) -> tuple[ComplexArray, ComplexArray]:
    """Poles and modal vectors (n, m), something added to K; the state is (omega y, y')."""
    omega = own.omega_rad_s
    spring = np.diag(omega) + added / omega
    state = np.block([[np.zeros_like(own.damping), np.diag(omega)], [-spring, -own.damping]])
    poles, vectors = scipy.linalg.eig(state)
    size = np.abs(poles)
    swings = np.flatnonzero(poles.imag > _SWINGS * size)
    order = swings[np.argsort(size[swings])]
    return poles[order], vectors[: len(omega), order] / omega[:, None]


def _of_unit_mass(vectors: ComplexArray, mass: Array) -> ComplexArray:
    modal = np.einsum("im,ij,jm->m", vectors, mass, vectors)
    return np.asarray(vectors / np.sqrt(modal))
