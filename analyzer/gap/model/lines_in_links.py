"""Lines of a link's frame that a fit may turn and shift across themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly, spatial_inertia
from armodal.analyzer.gap.model.effect import Builder, EffectWords, Instance
from armodal.analyzer.gap.model.geometry import across, skew
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import LINE_SHIFT_STD_M, LINE_TILT_STD
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.screws import line_sense
from armodal.protocols.arrays import frozen_array

__all__ = ["LineInLink", "described_line"]

Array = npt.NDArray[np.float64]

Body = Callable[[Assembly, Mapping[str, float]], None]

_STEP = 1e-6  # for slopes
_FREEDOMS = (
    ("tilt a", "", LINE_TILT_STD),
    ("tilt b", "", LINE_TILT_STD),
    ("shift a", "m", LINE_SHIFT_STD_M),
    ("shift b", "m", LINE_SHIFT_STD_M),
)


class LineInLink:
    """A line near a unit direction (3,) through a point (3,) of a link's frame, both in m.

    Its four moves are parameters, named after what it is a line `of` and after the link: two tilts
    and two shifts across the line a fit begins with.
    """

    def __init__(
        self, ordinary: Ordinary, link: int, direction: Array, point_m: Array, *, of: str
    ) -> None:
        self.link, self._of, self.name = link, of, ordinary.arm.joints[link].link.name
        self._direction, self._sides = direction, across(direction)
        self._nearest = point_m - direction * (direction @ point_m)
        self.parameters = tuple(
            Parameter(name=f"{of} {move} {self.name}", unit=unit, mean=0.0, std=std)
            for move, unit, std in _FREEDOMS
        )
        self.moves = tuple(p.name for p in self.parameters)

    def at(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return unit direction and nearest point of the line by its moves."""
        return self._at([values[move] for move in self.moves])

    def turn(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Twist (6,) of a unit turn about it, linear first; its slopes (4, 6) by the moves."""
        moves = [values[move] for move in self.moves]
        direction, sides = self._direction, self._sides
        u, p = self._at(moves)
        on = self._nearest + sides @ np.array(moves[2:])
        across_u = sides - np.outer(u, u @ sides)  # (3, 2)
        du = across_u / np.linalg.norm(direction + sides @ np.array(moves[:2]))
        turned = skew(p) @ du + skew(u) @ (du * (u @ on) + np.outer(u, on @ du))
        shifted = -skew(u) @ across_u
        slopes = np.block([[turned, shifted], [du, np.zeros((3, 2))]])
        return np.concatenate([skew(p) @ u, u]), slopes.T

    def travel(
        self, assembly: Assembly, values: Mapping[str, float], mass: str, mass_kg: float
    ) -> tuple[Array, dict[str, Array]]:
        """Motion along the line of a mass that hangs on it, by the coordinates so far, (n + 1,).

        That of the link's points on it, and of a coordinate to come, mass times stretch. `mass`
        names the parameter.

        Returns
        -------
        The row, and by parameter what it changes a unit: the mass, the line's own moves, and
        whatever moves coordinates otherwise.
        """
        turn, slopes = self.turn(values)
        # Point p moves by v + w x p: along u that is (u, p x u) . (v, w), the halves exchanged.
        rows = np.vstack([turn, slopes])[:, [3, 4, 5, 0, 1, 2]]
        rows = rows @ assembly.geometry.link_jacobian[self.link]
        row, *moved = np.pad(rows @ np.stack(assembly.columns, axis=1), ((0, 0), (0, 1)))
        row[-1] = 1.0 / mass_kg
        found = dict(zip(self.moves, moved, strict=True))
        found[mass] = -np.eye(row.size)[-1] / mass_kg**2
        for name, ways in assembly.motion_of.items():
            found[name] = np.zeros_like(row)
            for at, way in ways:
                found[name][at] += rows[0] @ way
        return row, found

    def body(self, mass_kg: str) -> tuple[tuple[Parameter, ...], Body]:
        """Return what adds to a posture a mass on the line that moves with the link across it.

        Parameters
        ----------
        mass_kg
            Name of the mass, all of whose weight hangs on the link.

        Returns
        -------
        The part of it that moves across with the link and its place along the line, from the
        nearest point; and what adds it.
        """
        carried, along = (
            f"{self._of} {what} {self.name}" for what in ("part across", "place along")
        )
        parameters = (
            Parameter(name=carried, unit="", mean=0.5, std=0.5, low=0.0, high=1.0),
            Parameter(name=along, unit="m", mean=0.0, std=LINE_SHIFT_STD_M),
        )
        names = (mass_kg, carried, along, *self.moves)

        def inertia(by: Array) -> tuple[Array, Array]:
            u, p = self._at(by[3:].tolist())
            q, w = p + by[2] * u, np.concatenate([u, np.cross(p, u)])
            point = spatial_inertia(1.0, q, np.zeros((3, 3))) - np.outer(w, w)
            return by[0] * by[1] * point, by[0] * np.append(1.0, q)

        @lru_cache(maxsize=2)  # for all postures
        def all_of_it(*by: float) -> tuple[Array, Array, Array]:
            here, moments = inertia(np.array(by))
            beside = [inertia(by + _STEP * way)[0] for way in np.eye(len(by))]
            slopes = (np.array(beside) - here) / _STEP
            return (
                frozen_array(here, np.float64),
                frozen_array(moments, np.float64),
                frozen_array(slopes, np.float64),
            )

        def add(assembly: Assembly, values: Mapping[str, float]) -> None:
            here, moments, slopes = all_of_it(*(values[name] for name in names))
            assembly.add_inertia(self.link, here, moments)
            for name, slope in zip(names, slopes, strict=True):
                assembly.inertia_of[name] = self.link, slope

        return parameters, add

    def describe(self, values: Mapping[str, float]) -> dict[str, object]:
        """Return where it is, in the arm file's words and the sense that every line has."""
        u, p = self.at(values)
        u = line_sense(u)
        return {"link": self.name, "direction": u.tolist(), "point_m": p.tolist()}

    def instance(
        self,
        words: EffectWords,
        own: Sequence[Parameter],
        build: Builder,
        *,
        material: float,
        is_also: tuple[str, str, float],
    ) -> Instance:
        """Return an effect along the line; the first of its own parameters is its size.

        Of `is_also` the first is the effect of that link that it also is, where the second, a
        parameter, is beyond the third.
        """
        size, *others = (p.name for p in own)
        name, by, beyond = is_also

        def is_it(values: Mapping[str, float], other: Instance) -> bool:
            return other.key == (name, self.name) and values[by] > beyond

        return Instance(
            effect=words,
            place=self.name,
            parameters=(*own, *self.parameters),
            builder=build,
            describe=self.describe,
            is_also=is_it,
            begins_at=self.moves,
            size=size,
            shapes=(*others, *self.moves),
            material=material,
            last=True,
        )

    def _at(self, moves: Sequence[float]) -> tuple[Array, Array]:
        u = self._direction + self._sides @ np.array(moves[:2])
        u = u / np.linalg.norm(u)
        p = self._nearest + self._sides @ np.array(moves[2:])
        return u, p - u * (u @ p)


def described_line(
    ordinary: Ordinary, description: Mapping[str, object]
) -> tuple[int, Array, Array] | None:
    """Return link, unit direction and point of the line an arm file describes, or None."""
    links = [joint.link.name for joint in ordinary.arm.joints]
    link = description.get("link")
    direction, point = (_vector(description.get(key)) for key in ("direction", "point_m"))
    if link not in links or direction is None or point is None or not direction.any():
        return None
    return links.index(str(link)), direction / np.linalg.norm(direction), point


def _vector(value: object) -> Array | None:
    return np.array(value) if isinstance(value, tuple) and len(value) == 3 else None
