"""Hinges along a link that gives way: how each moves, and which part of the compliance it has.

They are the same in every posture: asked for with the values they were last asked for with, they
are not made again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
import numpy.typing as npt
import scipy.special

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects.yielding_line import YieldingLine
from armodal.analyzer.gap.model.assembly import Inside
from armodal.analyzer.gap.model.long_links import SLICES

__all__ = ["Hinge", "hinges_along", "parts_along"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hinge:
    """One hinge; motions (N,) are the superset's, linear first."""

    inside: Inside
    motion: Array
    moved: tuple[tuple[str, Array], ...]  # parameters, and by what its motion changes a unit
    part_m: float  # of the link's length that it yields for
    part_slopes: Mapping[str, float]  # by what parameters change that a unit


def hinges_along(
    superset: Superset, yielding: YieldingLine, taper: str, middle: str
) -> Callable[[Mapping[str, float]], tuple[Hinge, ...]]:
    """Return what makes the hinges of a line by the values of its parameters.

    `taper` and `middle` name the parameters of `parts_along`.
    """
    line = yielding.line
    columns = superset.interface_columns(line.link)
    half = 0.5 * line.length_m / SLICES
    insides = [
        line.inside(superset, s - half, s + half, 1 + where)
        for where, s in enumerate(line.places_m)
    ]
    names = (taper, middle, *(p.name for p in yielding.parameters))

    def made(where: int, number: int, values: Mapping[str, float]) -> Hinge:
        motion = np.zeros((1 + len(yielding.moving), superset.n))
        motion[:, columns] = np.vstack(yielding.hinge(values, line.places_m[where], number))
        motion.setflags(write=False)
        parts, by_shape = parts_along(values[taper], values[middle])
        shares, by_sharing = yielding.shares(values)
        by_shapes = by_shape[:, where] * shares[number], parts[where] * by_sharing[:, number]
        slopes = (line.length_m * np.hstack(by_shapes)).tolist()
        return Hinge(
            inside=insides[where],
            motion=motion[0],
            moved=tuple(zip(yielding.moving, motion[1:], strict=True)),
            part_m=float(line.length_m * parts[where] * shares[number]),
            part_slopes=dict(zip((taper, middle, *yielding.sharing), slopes, strict=True)),
        )

    @lru_cache(maxsize=1)  # equations of all postures are put together one after the other
    def kept(*at: float) -> tuple[Hinge, ...]:
        values = dict(zip(names, at, strict=True))
        each = product(range(SLICES), range(yielding.n_hinges))
        return tuple(made(where, number, values) for where, number in each)

    return lambda values: kept(*(values[name] for name in names))


def parts_along(taper: float, middle: float) -> tuple[Array, Array]:
    """Return parts (SLICES,) of the whole at each place, and their slopes (2, SLICES).

    `taper` is ln of the softness at the tip over that at the root, `middle` of that at the middle
    over that of the ends.
    """
    place = (np.arange(SLICES) + 0.5) / SLICES - 0.5
    by = np.stack([place, 1.0 - 2.0 * np.abs(place)])
    parts = scipy.special.softmax(np.array([taper, middle]) @ by)
    return parts, parts * (by - (by @ parts)[:, None])
