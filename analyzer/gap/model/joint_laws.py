"""Torques of a joint that are no linear function of its turn, on top of its spring and damper.

An element resists the turn x by g(x), and by what it remembers where it slips. Rows are swings:
many at once, each with its own numbers.

References
----------
W. D. Iwan, J. Appl. Mech. 33 (1966) 893: springs that slip at limits evenly spread.
Krylov and Bogoliubov, Introduction to Non-Linear Mechanics (1947): equivalent linearisation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.protocols.plan_records import KnownMass

__all__ = [
    "Bent",
    "Element",
    "ElementOf",
    "JointLaw",
    "LinearLaw",
    "Linearised",
    "Play",
    "Sliders",
    "Tangent",
    "added_logs",
    "harmonic_spring",
    "over_a_swing",
    "rows_of",
    "stacked",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_AROUND = 256  # steps of a swing
_TINY = 1e-12
_LEAST = 0.02  # of a joint's spring or damper, that a law leaves


class Element(Protocol):
    """What resists; every field (n, ...) with a row a swing."""

    @property
    def n_memory(self) -> int:
        """Numbers remembered."""
        ...

    def resist(self, turn: Array, memory: Array) -> tuple[Array, Array]:
        """Torque in N m and its slope in N m/rad, (n,) each, at turns (n,) in rad."""
        ...

    def remember(self, turn: Array, memory: Array, step_s: float) -> Array:
        """(n, n_memory) once the step to a turn is done, which took so long."""
        ...

    def tangent(self, turn: Array, memory: Array, step_s: float) -> Tangent:
        """Slopes of `resist` and `remember` there."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Tangent:
    """How an element answers a small change of its turn and of what it remembers.

    What it remembers has no say in each other; (n, n_memory) but for the first.
    """

    by_turn: Array  # (n,) N m/rad
    by_memory: Array  # of the torque
    kept: Array  # of what is remembered, by itself before
    followed: Array  # by the turn


class ElementOf(Protocol):
    """Makes the element of a swing, each field with one row."""

    def __call__(self, values: Mapping[str, float], load: float) -> Element:
        """From all values by name, and the torque at rest in N m that the arm's weight puts on."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLaw:
    """A joint's own law: what its parameters make of it, and the swing they are counted by."""

    joint: str
    element: ElementOf
    swing_rad: float  # of a hit of the middle level, where it moves the joint most
    rate_rad_s: float  # of those swings: the joint's rate over its turn
    # Torque that the weight puts on it, of the arm and of a mass that is bolted on.
    load_n_m: Callable[[PostureGeometry, KnownMass | None], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearLaw:
    """What stands for a law on the lines of one posture and level."""

    log_k: float  # what the spring in its place adds to ln k
    log_c: float
    added: ComplexArray  # (m, 3, L) to the response
    by: Mapping[str, ComplexArray]  # by parameter: (m, 3, L) a unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Linearised:
    """A law about one point, on some lines (`linearised.py`)."""

    values: Mapping[str, float]  # of all parameters it depends on, there
    table: Mapping[tuple[object, ...], LinearLaw]  # by the lines' key

    def added(self, key: tuple[object, ...], values: Mapping[str, float]) -> ComplexArray:
        """(m, 3, L) to the response of some lines."""
        here = self.table[key]
        moved = ((by, values.get(n, self.values[n]) - self.values[n]) for n, by in here.by.items())
        return np.asarray(here.added + sum(by * step for by, step in moved if step))


@dataclass(frozen=True, slots=True, kw_only=True)
class Sliders:
    """Springs in series with dry friction, side by side (Jenkins elements).

    A film that shears lets a slider follow before it slips: by what it is behind, times `creep`.
    """

    stiffness: Array  # (n, N)
    limit: Array  # (n, N)
    creep_per_s: Array  # (n,)

    @property
    def n_memory(self) -> int:
        """Where each slider stands."""
        return int(self.limit.shape[1])

    def resist(self, turn: Array, memory: Array) -> tuple[Array, Array]:
        """None of them above its limit."""
        wanted = self.stiffness * (turn[:, None] - memory)
        held = np.minimum(np.maximum(wanted, -self.limit), self.limit)
        return held.sum(axis=1), np.where(held == wanted, self.stiffness, 0.0).sum(axis=1)

    def remember(self, turn: Array, memory: Array, step_s: float) -> Array:
        """A slider follows what pulls it beyond its limit."""
        reach = self.limit / np.maximum(self.stiffness, _TINY)
        there = turn[:, None]
        held = np.minimum(np.maximum(memory, there - reach), there + reach)
        if not self.creep_per_s.any():
            return np.asarray(held)
        follows = -np.expm1(-self.creep_per_s * step_s)[:, None]
        return np.asarray(held + follows * (there - held))

    def tangent(self, turn: Array, memory: Array, step_s: float) -> Tangent:
        """A slider holds what it holds until it slips."""
        holds = np.abs(self.stiffness * (turn[:, None] - memory)) <= self.limit
        follows = -np.expm1(-self.creep_per_s * step_s)[:, None]
        stiff = np.where(holds, self.stiffness, 0.0)
        return Tangent(
            by_turn=stiff.sum(axis=1),
            by_memory=-stiff,
            kept=np.where(holds, 1.0 - follows, 0.0),
            followed=np.where(holds, follows, 1.0),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Play:
    """A part of the spring that holds nothing over a play: what it does not hold there.

    `rest` is where in the play the joint stands while nobody hits it.
    """

    stiffness: Array  # (n,) of that part
    half: Array  # (n,)
    rest: Array  # (n,)

    @property
    def n_memory(self) -> int:
        """None."""
        return 0

    def resist(self, turn: Array, memory: Array) -> tuple[Array, Array]:
        """Minus what a spring without play would hold."""
        del memory
        at = turn + self.rest
        held = np.clip(at, -self.half, self.half) - np.clip(self.rest, -self.half, self.half)
        return -self.stiffness * held, np.where(np.abs(at) < self.half, -self.stiffness, 0.0)

    def remember(self, turn: Array, memory: Array, step_s: float) -> Array:
        """Nothing."""
        del turn, step_s
        return memory

    def tangent(self, turn: Array, memory: Array, step_s: float) -> Tangent:
        """Its slope alone."""
        del step_s
        return _of_no_memory(self.resist(turn, memory)[1])


@dataclass(frozen=True, slots=True, kw_only=True)
class Bent:
    """A spring whose secant stiffness is another by `part` at large turns: of x^2 / (x^2 + a^2)."""

    part: Array  # (n,) N m/rad
    bend: Array  # (n,) a in rad

    @property
    def n_memory(self) -> int:
        """None."""
        return 0

    def resist(self, turn: Array, memory: Array) -> tuple[Array, Array]:
        """As a cubic spring for small turns."""
        del memory
        x2, a2 = turn**2, self.bend**2
        return (
            self.part * turn * x2 / (x2 + a2),
            self.part * x2 * (x2 + 3.0 * a2) / (x2 + a2) ** 2,
        )

    def remember(self, turn: Array, memory: Array, step_s: float) -> Array:
        """Nothing."""
        del turn, step_s
        return memory

    def tangent(self, turn: Array, memory: Array, step_s: float) -> Tangent:
        """Its slope alone."""
        del step_s
        return _of_no_memory(self.resist(turn, memory)[1])


def _of_no_memory(slope: Array) -> Tangent:
    none = np.zeros((len(slope), 0))
    return Tangent(by_turn=slope, by_memory=none, kept=none, followed=none)


E = TypeVar("E", bound=Element)


def stacked(elements: Sequence[E], counts: Sequence[int]) -> E:
    """One element with the rows of all, each repeated."""
    first: Any = elements[0]
    columns: dict[str, Any] = {
        field.name: np.concatenate(
            [
                np.repeat(getattr(own, field.name), count, axis=0)
                for own, count in zip(elements, counts, strict=True)
            ]
        )
        for field in fields(first)
    }
    found: E = type(first)(**columns)
    return found


def rows_of(element: E, rows: npt.NDArray[np.int64]) -> E:
    """One element with some rows of another."""
    kept: Any = element
    return type(element)(**{field.name: getattr(kept, field.name)[rows] for field in fields(kept)})


def over_a_swing(element: Element, swing_rad: float, rate_rad_s: float) -> tuple[float, float]:
    """Stiffness, and damping times frequency, in N m/rad, of an element over a harmonic swing.

    The describing function of its one row: of the second time around, when sliders have found
    their place.
    """
    turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    step_s = 2.0 * np.pi / rate_rad_s / _AROUND
    memory = np.zeros((1, element.n_memory))
    torque = np.zeros(_AROUND)
    for _ in range(2):
        for i, x in enumerate(swing_rad * np.cos(turn)):
            torque[i] = element.resist(np.array([x]), memory)[0][0]
            memory = element.remember(np.array([x]), memory, step_s)
    return (
        2.0 * float(torque @ np.cos(turn)) / (_AROUND * swing_rad),
        -2.0 * float(torque @ np.sin(turn)) / (_AROUND * swing_rad),
    )


def harmonic_spring(
    law: JointLaw, values: Mapping[str, float], lines: PostureLines, geometry: PostureGeometry
) -> tuple[float, float]:
    """What a law adds to a joint's ln k and ln c for harmonic swings of the lines' level.

    That is the logarithm of the swing over the law's own.
    """
    element = law.element(values, law.load_n_m(geometry, lines.known_mass))
    swing_rad = law.swing_rad * float(np.exp(lines.level))
    stiffness, loss = over_a_swing(element, swing_rad, law.rate_rad_s)
    return added_logs(law, values, stiffness, loss / law.rate_rad_s)


def added_logs(
    law: JointLaw, values: Mapping[str, float], stiffness: float, damping: float
) -> tuple[float, float]:
    """What N m/rad and N m s/rad more add to the joint's ln k and ln c."""
    k, c = (float(np.exp(values[f"ln {what} {law.joint}"])) for what in "kc")
    return (
        float(np.log(max(1.0 + stiffness / k, _LEAST))),
        float(np.log(max(1.0 + damping / c, _LEAST))),
    )
