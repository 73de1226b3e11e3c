"""Hinges along a link that gives way: how each moves, and which part of the compliance it has.

They are the same in every posture: asked for with the values they were last asked for with, they
are not made again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import scipy.special

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects.yielding_line import YieldingLine
from armodal.analyzer.gap.model.assembly import Inside
from armodal.analyzer.gap.model.long_links import SLICES

__all__ = ["Hinge", "hinges_along", "parts_along", "soft_places"]

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
    superset: Superset, yielding: YieldingLine, where: tuple[str, str, str, str]
) -> Callable[[Mapping[str, float]], tuple[Hinge, ...]]:
    """Return what makes the hinges of a line by the values of its parameters.

    `where` names those of `soft_places` and of `parts_along`.
    """
    line = yielding.line
    columns = superset.interface_columns(line.link)
    length_m = line.length_m
    of_place, of_parts = where[:2], where[2:]
    names = (*where, *(p.name for p in yielding.parameters))

    def made(values: Mapping[str, float]) -> tuple[Hinge, ...]:
        edges, by_edges = soft_places(*(values[name] for name in of_place))
        parts, by_parts = parts_along(*(values[name] for name in of_parts))
        shares, by_sharing = yielding.shares(values)
        found = []
        for i, part in enumerate(parts):
            slopes = {n: (b[i], b[i + 1]) for n, b in zip(of_place, by_edges.tolist(), strict=True)}
            inside = line.inside(superset, (edges[i], edges[i + 1]), slopes)
            at_m = 0.5 * (edges[i] + edges[i + 1]) * length_m
            along_m = 0.5 * (by_edges[:, i] + by_edges[:, i + 1]) * length_m
            for number, share in enumerate(shares):
                twist, moved, along = yielding.hinge(values, at_m, number)
                motion = np.zeros((1 + len(moved) + len(along_m), superset.n))
                motion[:, columns] = np.vstack([twist, moved, np.outer(along_m, along)])
                motion.setflags(write=False)
                by = length_m * np.append(by_parts[:, i] * share, part * by_sharing[:, number])
                shaping = (*of_parts, *yielding.sharing)
                found.append(
                    Hinge(
                        inside=inside,
                        motion=motion[0],
                        moved=tuple(zip((*yielding.moving, *of_place), motion[1:], strict=True)),
                        part_m=float(length_m * part * share),
                        part_slopes=dict(zip(shaping, by.tolist(), strict=True)),
                    )
                )
        return tuple(found)

    @lru_cache(maxsize=1)  # equations of all postures are put together one after the other
    def kept(*at: float) -> tuple[Hinge, ...]:
        return made(dict(zip(names, at, strict=True)))

    return lambda values: kept(*(values[name] for name in names))


def soft_places(place: float, stretch: float) -> tuple[Array, Array]:
    """Return edges (SLICES + 1,) of the slices that give way, and their slopes (2, SLICES + 1).

    Parts of the length. A `stretch` of it is soft, all of it at 1; a short one is about `place`,
    and any lies within the link.
    """
    slices = np.arange(SLICES + 1) / SLICES - 0.5
    off = place - 0.5
    edges = 0.5 + (1.0 - stretch) * off + stretch * slices
    return edges, np.stack([np.full(SLICES + 1, 1.0 - stretch), slices - off])


def parts_along(taper: float, middle: float) -> tuple[Array, Array]:
    """Return parts (SLICES,) of the whole in each slice, and their slopes (2, SLICES).

    `taper` is ln of the softness at the soft stretch's far end over that at its near one, `middle`
    of that at its middle over that of its ends.
    """
    place = (np.arange(SLICES) + 0.5) / SLICES - 0.5
    by = np.stack([place, 1.0 - 2.0 * np.abs(place)])
    parts = scipy.special.softmax(np.array([taper, middle]) @ by)
    return parts, parts * (by - (by @ parts)[:, None])
