"""How FRFs change where the motion of coordinates does: with joint angles, with an axis's place."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.response import Response, of_hits, real_times
from armodal.analyzer.gap.model.systems import MotionSlopes, Slopes

__all__ = ["by_motion", "by_slopes"]

Array = npt.NDArray[np.floating[Any]]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def by_slopes(found: Response, slopes: Slopes) -> ComplexArray:
    """Derivatives (k, P, m, 3, L) by the k joint angles; slopes of P postures."""
    system = found.system
    x, Y = found.x, found.under_loads
    P, m, n, L = x.shape
    k = slopes.mass.shape[1]
    real = x.real.dtype
    dU = slopes.moved.transpose(0, 2, 1, 4, 3).reshape(P, m, k * n, 3).astype(real, copy=False)
    load = (dU @ system.moved).reshape(P, m, k, n, n)
    load = (load + load.swapaxes(-1, -2)) * system.sensor_mass_kg[:, None, None, None, None]
    rows = np.empty((P, m, k, n + 3, n), real)
    rows[..., :n, :] = slopes.mass[:, None] + load
    seen, tilted = (
        (system.mix @ of.transpose(0, 2, 3, 1, 4).reshape(P, m, 3, k * n).astype(real, copy=False))
        .reshape(P, m, 3, k, n)
        .swapaxes(2, 3)
        for of in (slopes.seen, slopes.tilted)
    )
    rows[..., n:, :] = seen
    s2 = (found.s_rad_s**2)[:, None, None]  # (P, 1, 1, L)
    moved = real_times(rows.reshape(P, m, -1, n), s2 * x).reshape(P, m, k, n + 3, L)
    tilt = real_times(np.ascontiguousarray(tilted).reshape(P, m, -1, n), x)
    push = of_hits(np.einsum("pha,pkhan->phkn", system.force, slopes.hit), found.hit)
    pull = moved[..., :n, :]
    pull -= push[..., None].astype(real, copy=False)
    y = moved[..., n:, :] + tilt.reshape(P, m, k, 3, L)
    y *= found.factor[:, None, None, None]
    part = np.empty_like(y)
    for i in range(n):
        np.multiply(Y[:, :, None, i], pull[..., i, None, :], out=part)
        y -= part
    return np.asarray(y.transpose(2, 0, 1, 3, 4))


def by_motion(found: Response, slopes: MotionSlopes) -> ComplexArray:
    """Derivatives (k, P, m, 3, L) by k ways in which a coordinate moves otherwise."""
    system, at, k = found.system, slopes.at, len(slopes.at)
    x, Y = found.x, found.under_loads
    P, m, n, _ = x.shape
    s2 = (found.s_rad_s**2)[:, None, None]  # (P, 1, 1, L)
    mass_kg = system.sensor_mass_kg[:, None, None, None]
    inertia = slopes.mass[:, None] + mass_kg * (slopes.moved.swapaxes(2, 3) @ system.moved)

    def through(spring: Array, of: ComplexArray) -> ComplexArray:
        """(P, m, k, ..., L) of inertia and spring with what (P, m, n, ..., L) moves."""
        rows = np.concatenate([inertia, np.broadcast_to(spring[:, None], inertia.shape)], 2)
        rows = rows.astype(of.real.dtype, copy=False)
        both = real_times(rows, of.reshape(P, m, n, -1)).reshape(P, m, 2 * k, *of.shape[3:])
        weight = s2 if of.ndim == 4 else s2[..., None, :]
        return np.asarray(weight * both[:, :, :k] + both[:, :, k:])

    push = np.einsum("pha,phak->phk", system.force, slopes.hit).astype(x.real.dtype)
    pull = through(slopes.stiffness_row, x) - of_hits(push, found.hit)[..., None]
    load = through(slopes.stiffness_column, Y)  # (P, m, k, 3, L)
    seen, tilted = (
        (system.mix @ of).swapaxes(2, 3)[..., None].astype(x.real.dtype)
        for of in (slopes.seen, slopes.tilted)
    )
    load -= found.factor[:, None, None, None] * (s2[..., None, :] * seen + tilted)
    y = Y[:, :, at] * pull[:, :, :, None]
    y += load * x[:, :, at][:, :, :, None]
    return np.asarray(-y.transpose(2, 0, 1, 3, 4))
