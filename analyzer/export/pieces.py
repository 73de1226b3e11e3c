"""Moments of inertia that bodies can have, for the pieces of a link.

A link that bends is cut into pieces that share its mass evenly, as a rod does. A link whose mass
lies nearer together than a rod's leaves its pieces moments which no body has, and which simulators
refuse. A body's second moment S = tr(J) / 2 - J is positive semidefinite (R. Featherstone, Rigid
Body Dynamics Algorithms (2008), section 2.13). Here the pieces' centres come nearer together until
they leave such moments. The link as a whole keeps its mass, centre and inertia.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Piece", "physical_pieces"]

Array = npt.NDArray[np.float64]

_ROUNDS = 200
_CLOSE = 1e-12  # of the largest moment
_LEAST = 1e-9  # of the largest moment: above what rounding leaves below zero
_LEFT = 1e-6  # of the largest moment: what pieces keep along a line that has nothing left


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A body's mass, centre and inertia about it, in the link's frame."""

    mass_kg: float
    center_m: Array  # (3,)
    inertia_kg_m2: Array  # (3, 3)


def physical_pieces(pieces: Sequence[Piece]) -> list[Piece]:
    """Return pieces that are bodies, and as a whole what they were.

    Moments are shared by alternating projections between their sum and the cones (J. von Neumann,
    Functional Operators II (1950), chapter 13). Of a link that is no body itself some are larger.
    """
    own = [_second_moment(0.5 * (p.inertia_kg_m2 + p.inertia_kg_m2.T)) for p in pieces]
    if all(np.linalg.eigvalsh(S)[0] >= 0.0 for S in own):
        return list(pieces)
    masses = np.array([p.mass_kg for p in pieces])
    centers = np.array([p.center_m for p in pieces])
    middle = masses @ centers / masses.sum()
    size = max(float(np.abs(S).max()) for S in own)
    whole = sum(own, np.zeros((3, 3))) + _spread(masses, centers - middle)
    apart = _nearer(masses, centers - middle, whole, _LEFT * size)
    total = whole - _spread(masses, apart)
    least = _LEAST * size
    found = [_at_least(S, least) for S in own]
    for _ in range(_ROUNDS):
        beyond = sum(found, -total) / len(found)
        if np.abs(beyond).max() <= _CLOSE * size:
            break
        found = [_at_least(S - beyond, least) for S in found]
    return [
        Piece(
            mass_kg=piece.mass_kg,
            center_m=middle + offset,
            inertia_kg_m2=np.trace(S) * np.eye(3) - S,
        )
        for piece, offset, S in zip(pieces, apart, found, strict=True)
    ]


def _nearer(masses: Array, offsets: Array, whole: Array, left: float) -> Array:
    """Offsets of the centres, drawn together along what they spread more than the link does."""
    for _ in range(3):
        values, axes = np.linalg.eigh(whole - _spread(masses, offsets))
        if values[0] >= 0.0:
            break
        line = axes[:, 0]
        along = offsets @ line
        spread = float(masses @ along**2)
        if spread <= 0.0:
            break
        part = np.sqrt(max(1.0 + (values[0] - left) / spread, 0.0))
        offsets = offsets + np.outer((part - 1.0) * along, line)
    return offsets


def _spread(masses: Array, offsets: Array) -> Array:
    return np.asarray(np.einsum("p,pi,pj->ij", masses, offsets, offsets))


def _second_moment(inertia: Array) -> Array:
    return np.asarray(0.5 * np.trace(inertia) * np.eye(3) - inertia)


def _at_least(moment: Array, least: float) -> Array:
    values, axes = np.linalg.eigh(moment)
    return np.asarray(axes @ np.diag(np.maximum(values, least)) @ axes.T)
