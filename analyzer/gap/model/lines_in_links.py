"""Lines of a link's frame that a fit may turn and shift across themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.geometry import across, skew
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.screws import line_sense

__all__ = ["LineInLink", "described_line"]

Array = npt.NDArray[np.float64]

_TILT_STD, _SHIFT_STD_M = 1.0, 0.15
_FREEDOMS = (
    ("tilt a", "", _TILT_STD),
    ("tilt b", "", _TILT_STD),
    ("shift a", "m", _SHIFT_STD_M),
    ("shift b", "m", _SHIFT_STD_M),
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

    def describe(self, values: Mapping[str, float]) -> dict[str, object]:
        """Return where it is, in the arm file's words and the sense that every line has."""
        u, p = self.at(values)
        u = line_sense(u)
        return {"link": self.name, "direction": u.tolist(), "point_m": p.tolist()}

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
