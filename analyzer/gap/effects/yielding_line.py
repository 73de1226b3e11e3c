"""The line along which a long link gives way: where it lies, and how easily about each direction.

It is near the line that is believed: off it, turned and bowed by a little, both ways across. A
link that bends has two hinges at each place. Of its yield about directions across, a symmetric
2 x 2 matrix, they are the columns of Cholesky's factor: one stands as it is, the other leans
towards it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.special

from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.long_links import LongLink
from armodal.analyzer.gap.model.priors import LEAN_STD
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["YieldingLine"]

Array = npt.NDArray[np.float64]

_ASIDE_STD_M = 0.03  # of the line, across it
# Of it about its middle: further it is another line, as an axis is no twist (`link_axis`).
_TURN_STD_RAD, _TURN_MOST_RAD = 0.1, 0.2
# By how much it bows, of its length: a parabola whose ends stand 40 degrees to each other does.
_BOW_STD = 0.09
# ln of the softness about one direction across over that about the other: of a thin box, 0.63 as
# wide as high.
_FLAT_STD = 0.7


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldingLine:
    """A line near a long link's, by the values of its parameters; the link's frame."""

    line: LongLink
    bends: bool  # about two directions across; else it twists about itself
    word: str  # that its parameters' names begin with

    @property
    def n_hinges(self) -> int:
        """Return how many stand at each place."""
        return 2 if self.bends else 1

    @property
    def moving(self) -> tuple[str, ...]:
        """Return what moves hinges: shifts, turns, bows, two each, and a lean where it bends."""
        return (*self._aside, *self._turn, *self._bow, *self._shape[1:])

    @property
    def sharing(self) -> tuple[str, ...]:
        """Return the names of what shares a place's yield among its hinges."""
        return self._shape

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Return all of them."""
        of = [(name, "m", _ASIDE_STD_M, np.inf) for name in self._aside]
        of += [(name, "rad", _TURN_STD_RAD, _TURN_MOST_RAD) for name in self._turn]
        of += [(name, "", _BOW_STD, np.inf) for name in self._bow]
        shape = zip(self._shape, (_FLAT_STD, LEAN_STD), strict=False)
        of += [(name, "", std, np.inf) for name, std in shape]
        return tuple(
            Parameter(name=name, unit=unit, mean=0.0, std=std, low=-most, high=most, untold=0.0)
            for name, unit, std, most in of
        )

    def hinge(
        self, values: Mapping[str, float], s_m: float, number: int
    ) -> tuple[Array, Array, Array]:
        """Return the twist (6,) of a hinge at s, linear first, slopes (k, 6) by `moving`, by s.

        The line is turned to first order, and bows as a parabola between its ends; hinges stand
        across its tangent, or along it.
        """
        off, turn, bow = self._moved(values)
        beside, along = across(self.line.along).T, self.line.along
        arm, length = s_m - 0.5 * self.line.length_m, self.line.length_m
        bowed, by_bow = length - 4.0 * arm**2 / length, -8.0 * arm / length
        tilt = turn + by_bow * bow
        u, by_turn = _unit(along + tilt @ beside, beside)
        leans = []
        if self.bends:  # about directions that stay across
            lean = values[self._shape[1]] * number
            sides = np.array([[1.0, 0.0], [lean, 1.0]])[number]
            size = float(np.linalg.norm(sides))  # a hinge that leans is no unit
            changes = [*-np.outer(sides, along), number * (beside[0] - tilt[0] * along)]
            unit, slopes = _unit(sides @ beside - (sides @ tilt) * along, np.array(changes))
            u, by_turn = size * unit, size * slopes[:2]
            leans = [size * slopes[2] + number * lean / size * unit]
        p = self.line.start_m + s_m * along + (off + arm * turn + bowed * bow) @ beside
        levers = np.cross(beside, u)
        by_aside = np.hstack([levers, np.zeros((2, 3))])
        by_tilt = np.hstack([np.cross(p, by_turn), by_turn])
        moved = [*by_aside, *(arm * by_aside + by_tilt), *(bowed * by_aside + by_bow * by_tilt)]
        leant = [np.concatenate([np.cross(p, change), change]) for change in leans]
        bent = by_turn.T @ bow * (-8.0 / length)  # of u, further along
        beyond = np.cross(along + tilt @ beside, u) + np.cross(p, bent)
        by_s = np.concatenate([beyond, bent])
        return np.concatenate([np.cross(p, u), u]), np.array([*moved, *leant]), by_s

    def shares(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return the part (n,) of a place's yield that each hinge has, and slopes (k, n).

        By `sharing`. They yield one about the line, and one each on the mean of all directions
        across.
        """
        if not self.bends:
            return np.ones(1), np.zeros((0, 1))
        flat, lean = (values[name] for name in self._shape)
        w = scipy.special.softmax([0.5 * flat, -0.5 * flat])
        whole = 1.0 + w[1] * lean**2  # a hinge that leans is no unit
        dw = np.array([[1.0, -1.0], [0.0, 0.0]]) * w[0] * w[1]
        slope = np.array([-w[0] * w[1] * lean**2, 2.0 * w[1] * lean])
        return 2.0 * w / whole, 2.0 * dw / whole - 2.0 * w * slope[:, None] / whole**2

    def ends(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return its root and tip, each (3,)."""
        off, tilt, _ = self._moved(values)
        beside = across(self.line.along)
        middle = self.line.start_m + 0.5 * self.line.length_m * self.line.along + beside @ off
        along = self.line.along + beside @ tilt
        half = 0.5 * self.line.length_m * along / np.linalg.norm(along)
        return middle - half, middle + half

    def bow_m(self, values: Mapping[str, float]) -> Array:
        """Return by how much its middle stands beside the line of its ends, (3,)."""
        *_, bow = self._moved(values)
        return np.asarray(self.line.length_m * across(self.line.along) @ bow)

    def softest(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return directions (3, n) about which it gives way, softest first, and yields (n,).

        Two across, whose yields are two together, or the line.
        """
        shares, _ = self.shares(values)
        u = np.stack(
            [self.hinge(values, 0.5 * self.line.length_m, i)[0][3:] for i in range(self.n_hinges)]
        )
        yields, directions = np.linalg.eigh((u.T * shares) @ u)
        at = slice(None, -self.n_hinges - 1, -1)
        return directions[:, at], yields[at]

    @property
    def _aside(self) -> tuple[str, ...]:
        return self._names("aside a", "aside b")

    @property
    def _turn(self) -> tuple[str, ...]:
        return self._names("turn a", "turn b")

    @property
    def _bow(self) -> tuple[str, ...]:
        return self._names("bow a", "bow b")

    @property
    def _shape(self) -> tuple[str, ...]:
        return self._names("flat", "lean") if self.bends else ()

    def _names(self, *what: str) -> tuple[str, ...]:
        return tuple(f"{self.word} {one} {self.line.name}" for one in what)

    def _moved(self, values: Mapping[str, float]) -> tuple[Array, Array, Array]:
        """(2,) off the line believed, by what it is turned, and by what it bows."""
        of_each = (self._aside, self._turn, self._bow)
        off, turn, bow = (np.array([values[name] for name in of]) for of in of_each)
        return off, turn, bow


def _unit(u: Array, slopes: Array) -> tuple[Array, Array]:
    """A direction (3,) of length one, and its slopes (k, 3)."""
    size = float(np.linalg.norm(u))
    unit = u / size
    return unit, (slopes - np.outer(slopes @ unit, unit)) / size
