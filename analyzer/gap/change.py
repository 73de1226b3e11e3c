"""What a parameter's step changes in the equations of several postures, and in their FRFs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import System
from analyzer.gap.response import Response, applied, lines_last, of_hits

__all__ = ["Change", "by_change"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Difference of two systems over a parameter's step; None where nothing changes."""

    mass: Array | None = None
    damping: Array | None = None
    stiffness: Array | None = None
    loss: Array | None = None
    moved: Array | None = None
    seen: Array | None = None
    tilted: Array | None = None
    mix: Array | None = None
    hit: Array | None = None
    force: Array | None = None
    sensor_mass_kg: Array | None = None

    @classmethod
    def between(cls, before: System, after: System, step: float) -> Change:
        """Change a unit of the parameter makes."""
        found: dict[str, Any] = {}
        for name in cls.__slots__:
            old, new = getattr(before, name), getattr(after, name)
            if not np.array_equal(old, new):
                found[name] = (new - old) / step
        return cls(**found)


def by_change(found: Response, change: Change) -> ComplexArray:
    """Derivative (P, m, 3, L) by a parameter that changes the systems as told."""
    system, s = found.system, found.s_rad_s
    P, L, m, n = found.x.shape
    flat = found.x.reshape(P, L * m, n)
    dZx = np.zeros((P, L, m, n), dtype=np.complex128)
    for matrix, kind in (
        (change.mass, "mass"),
        (change.damping, "damping"),
        (change.stiffness, "stiffness"),
        (change.loss, "loss"),
    ):
        if matrix is not None:
            by = (flat @ matrix.swapaxes(1, 2)).reshape(P, L, m, n)
            dZx += found.weight(kind)[:, :, None, None] * by
    U = system.moved[:, None]
    s2 = (s**2)[:, :, None, None]
    if change.sensor_mass_kg is not None:
        load = applied(U.swapaxes(-1, -2), applied(U, found.x))
        dZx += change.sensor_mass_kg[:, None, None, None] * s2 * load
    if change.moved is not None and system.sensor_mass_kg.any():
        dU = change.moved[:, None]
        both = applied(dU.swapaxes(-1, -2), applied(U, found.x)) + applied(
            U.swapaxes(-1, -2), applied(dU, found.x)
        )
        dZx += system.sensor_mass_kg[:, None, None, None] * s2 * both
    if change.hit is not None:
        push = np.einsum("pha,phan->phn", system.force, change.hit)
        dZx -= of_hits(push, found.hit)[:, None]
    if change.force is not None:
        push = np.einsum("pha,phan->phn", change.force, system.hit)
        dZx -= of_hits(push, found.hit)[:, None]
    y = -applied(found.under_loads, dZx)
    more = np.zeros_like(y)
    if change.seen is not None:
        more += s2 * applied(change.seen[:, None], found.x)
    if change.tilted is not None:
        more += applied(change.tilted[:, None], found.x)
    if change.seen is not None or change.tilted is not None:
        y = y + found.factor[:, :, None, None] * applied(system.mix[:, None], more)
    if change.mix is not None:
        y = y + applied(change.mix[:, None], found.true_axes)
    return lines_last(y)
