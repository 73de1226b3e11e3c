"""The line along which a long link gives way: where it lies, and how easily about each direction.

It is near the line that is believed: off it and turned by a little, both ways across.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.special

from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.long_links import LongLink
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["Way", "YieldingLine", "about_the_line", "across_the_line"]

Array = npt.NDArray[np.float64]

_ASIDE_STD_M = 0.03  # of the line, across it
_TURN_STD_RAD = 0.1  # of it about its middle
# ln of the softness about one direction across over that about the other: of a thin box, 0.63 as
# wide as high.
_FLAT_STD = 0.7


@dataclass(frozen=True, slots=True)
class Way:
    """A direction about which each place of a link gives way, while its line lies as believed."""

    direction: Array  # (3,) unit
    turns: Array  # (2, 3) by what a turn of the line along each direction across changes it
    share: Array  # (2,) slopes of the logarithm of its part of the yield, before all make one


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldingLine:
    """A line near a long link's, by the values of its parameters; the link's frame."""

    line: LongLink
    ways: Sequence[Way]
    word: str  # that its parameters' names begin with

    @property
    def aside(self) -> tuple[str, ...]:
        """Return the names of its shifts across."""
        return self._names("aside")

    @property
    def turn(self) -> tuple[str, ...]:
        """Return the names of its turns towards each direction across."""
        return self._names("turn")

    @property
    def flat(self) -> tuple[str, ...]:
        """Return the names of what makes it softer about one direction; none about one alone."""
        return self._names("flat") if len(self.ways) > 1 else ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Return all of them."""
        of = (
            (self.aside, "m", _ASIDE_STD_M),
            (self.turn, "rad", _TURN_STD_RAD),
            (self.flat, "", _FLAT_STD),
        )
        return tuple(
            Parameter(name=name, unit=unit, mean=0.0, std=std, untold=0.0)
            for names, unit, std in of
            for name in names
        )

    def hinge(self, values: Mapping[str, float], s_m: float, way: Way) -> tuple[Array, Array]:
        """Return the twist (6,) of a hinge at s, linear first, and its slopes (4, 6).

        By `aside` and `turn`; to first order in the turn.
        """
        off, tilt = self._moved(values)
        beside = across(self.line.along).T
        arm = s_m - 0.5 * self.line.length_m
        u = way.direction + tilt @ way.turns
        p = self.line.start_m + s_m * self.line.along + (off + arm * tilt) @ beside
        levers = np.cross(beside, u)
        by_aside = np.hstack([levers, np.zeros((2, 3))])
        by_turn = np.hstack([arm * levers + np.cross(p, way.turns), way.turns])
        return np.concatenate([np.cross(p, u), u]), np.concatenate([by_aside, by_turn])

    def shares(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return the part (n,) of a place's yield that each way has, and slopes (2 or 0, n).

        By `flat`. Together they are one about the line, and one each about two directions across.
        """
        flat = np.array([values[name] for name in self.flat])
        by = np.stack([way.share for way in self.ways], axis=1)[: len(flat)]
        whole = 2.0 if len(flat) else 1.0
        parts = scipy.special.softmax(flat @ by)
        return whole * parts, whole * parts * (by - (by @ parts)[:, None])

    def ends(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return its root and tip, each (3,)."""
        off, tilt = self._moved(values)
        beside = across(self.line.along)
        middle = self.line.start_m + 0.5 * self.line.length_m * self.line.along + beside @ off
        along = self.line.along + beside @ tilt
        half = 0.5 * self.line.length_m * along / np.linalg.norm(along)
        return middle - half, middle + half

    def softest(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return directions (3, k) about which it gives way, softest first, and yields (k,).

        Two across, whose yields are two together, or the line.
        """
        shares, _ = self.shares(values)
        u = np.stack([way.direction for way in self.ways])
        yields, directions = np.linalg.eigh((u.T * shares) @ u)
        k = min(len(self.ways), 2)
        return directions[:, : -k - 1 : -1], yields[: -k - 1 : -1]

    def _names(self, what: str) -> tuple[str, ...]:
        return tuple(f"{self.word} {what} {letter} {self.line.name}" for letter in "ab")

    def _moved(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """(2,) off the line believed, and by what it is turned."""
        off, tilt = (np.array([values[name] for name in of]) for of in (self.aside, self.turn))
        return off, tilt


def about_the_line(line: LongLink) -> list[Way]:
    """Return the line itself, which turns with it."""
    return [Way(line.along, across(line.along).T, np.zeros(2))]


def across_the_line(line: LongLink) -> list[Way]:
    """Return three directions across, a sixth of a turn apart: together they make any yield.

    They stay across a line that turns.
    """
    beside = across(line.along)
    ways = []
    for angle in np.pi / 3.0 * np.arange(3):
        direction = beside @ [np.cos(angle), np.sin(angle)]
        turns = -np.outer(beside.T @ direction, line.along)
        ways.append(Way(direction, turns, np.array([np.cos(2.0 * angle), np.sin(2.0 * angle)])))
    return ways
