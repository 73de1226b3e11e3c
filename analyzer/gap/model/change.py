"""What a parameter's step changes in the equations of several postures, and in their FRFs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import System
from armodal.analyzer.gap.model.response import Response, of_hits, real_times

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
    system, x = found.system, found.x
    dZx = np.zeros_like(x)
    for matrix, kind in (
        (change.mass, "mass"),
        (change.damping, "damping"),
        (change.stiffness, "stiffness"),
        (change.loss, "loss"),
    ):
        if matrix is not None:
            dZx += found.weight(kind)[:, None, None] * real_times(matrix[:, None], x)
    U = system.moved
    s2 = (found.s_rad_s**2)[:, None, None]
    if change.sensor_mass_kg is not None:
        load = real_times(U.swapaxes(-1, -2) @ U, x)
        dZx += change.sensor_mass_kg[:, None, None, None] * s2 * load
    if change.moved is not None and system.sensor_mass_kg.any():
        both = change.moved.swapaxes(-1, -2) @ U
        both = both + both.swapaxes(-1, -2)
        dZx += system.sensor_mass_kg[:, None, None, None] * s2 * real_times(both, x)
    for force, hit in ((system.force, change.hit), (change.force, system.hit)):
        if force is not None and hit is not None:
            push = np.einsum("pha,phan->phn", force, hit)
            dZx -= of_hits(push, found.hit)[..., None]
    y = -np.asarray(sum(found.under_loads[:, :, i] * dZx[:, :, i, None] for i in range(x.shape[2])))
    more = np.zeros_like(y)
    if change.seen is not None:
        more += s2 * real_times(change.seen, x)
    if change.tilted is not None:
        more += real_times(change.tilted, x)
    y += found.factor[:, None, None] * real_times(system.mix, more)
    if change.mix is not None:
        y += real_times(change.mix, found.true_axes)
    return y
