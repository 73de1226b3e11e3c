"""How FRFs change where the motion of coordinates does: with joint angles, with an axis's place."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.line_arrays import of_hits, real_times
from armodal.analyzer.gap.model.response import Response
from armodal.analyzer.gap.model.systems import MotionSlopes, Slopes

__all__ = ["by_motion", "by_slopes"]

Array = npt.NDArray[np.floating[Any]]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def by_slopes(found: Response, slopes: Slopes) -> ComplexArray:
    """Derivatives (k, P, m, 3, L) by the k joint angles; slopes of P postures."""
    slopes = slopes.among(found.moving)
    system = found.system
    x, Y = found.x, found.under_loads
    P, m, n, L = x.shape
    k = slopes.before.shape[1]

    def rows(of: Array) -> Array:
        """(P, m or 1, k r, n) of (P, k, m or 1, r, n)."""
        of = of.astype(x.real.dtype, copy=False).swapaxes(1, 2)
        return of.reshape(P, of.shape[1], -1, n)

    # The two sides of what changes in M, and of what does in the accelerometer's inertia U'U.
    turned = np.concatenate([slopes.before, slopes.carried], axis=2)  # (P, k, 12, n)
    sides = rows(turned[:, :, None]), rows(slopes.moved), system.moved.astype(x.real.dtype)
    s2 = (found.s_rad_s**2)[:, None, None]  # (P, 1, 1, L)
    of_x, moves_x, moved_x = (real_times(side, -s2 * x) for side in sides)
    Y = Y.reshape(P, m, n, 3 * L)
    of_Y, moves_Y, moved_Y = (real_times(side, Y).reshape(P, m, -1, 3, L) for side in sides)
    mass_kg = system.sensor_mass_kg[:, None, None, None]
    moves_x, moved_x = moves_x * mass_kg, moved_x * mass_kg

    seen, tilted = (rows(system.mix[:, None] @ of) for of in (slopes.seen, slopes.tilted))
    y = (s2 * real_times(seen, x) + real_times(tilted, x)).reshape(P, m, k, 3, L)
    y *= found.factor[:, None, None, None]
    push = of_hits(np.einsum("pha,pkhan->phkn", system.force, slopes.hit), found.hit)
    y += real_times(push.astype(x.real.dtype, copy=False), Y).reshape(y.shape)
    products = [
        *_products(of_Y, of_x, np.roll(np.arange(12), 6)),
        *_products(moves_Y, moved_x, np.arange(3)),
        *_products(moved_Y, moves_x, np.arange(3)),
    ]
    part = np.empty_like(y)
    for load, motion in products:
        np.multiply(load, motion, out=part)
        y += part
    return np.asarray(y.transpose(2, 0, 1, 3, 4))


def _products(
    loads: ComplexArray, motions: ComplexArray, order: npt.NDArray[np.int64]
) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    """Give factors of products, (P, m, k or 1, 3, L) and (P, m, k or 1, 1, L) each.

    Of (P, m, r or k r, 3, L) and (P, m, r or k r, L); `order` (r,) of the motions.
    """
    r = len(order)
    loads, motions = (
        of.reshape(*of.shape[:2], -1, r, *of.shape[3:]) for of in (loads, motions[:, :, :, None])
    )
    for i, j in enumerate(order):
        yield loads[:, :, :, i], motions[:, :, :, j]


def by_motion(found: Response, slopes: MotionSlopes) -> ComplexArray:
    """Derivatives (k, P, m, 3, L) by k ways in which a coordinate moves otherwise."""
    moves = found.places[slopes.at] >= 0
    y = np.zeros((len(moves), *found.true_axes.shape), dtype=found.true_axes.dtype)
    if moves.any():
        y[moves] = _by_moving(found, slopes.among(found.moving, moves))
    return y


def _by_moving(found: Response, slopes: MotionSlopes) -> ComplexArray:
    """Of coordinates that are not locked."""
    system, at, k = found.system, found.places[slopes.at], len(slopes.at)
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
