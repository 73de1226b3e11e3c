"""What an effect is: words for people, parameters, and what it does to the equations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from armodal.analyzer.gap.model.joint_laws import (
    JointLaw,
    Linearised,
    LinearLaw,
    harmonic_spring,
)
from armodal.analyzer.gap.model.space import Parameter, Space

if TYPE_CHECKING:
    from armodal.analyzer.gap.model.assembly import Assembly
    from armodal.analyzer.gap.model.lines import PostureLines

__all__ = [
    "Alternatives",
    "Builder",
    "Describer",
    "EffectWords",
    "InitialValues",
    "Instance",
    "IsAlso",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectWords:
    """What a lab head reads about an effect."""

    name: str  # the key in files and JSON
    title: str  # in the field's words
    changes: str  # degrees of freedom released, terms of M, C, K, input, sensors
    signature: str
    confused_with: tuple[str, ...] = ()  # names of effects
    contains: tuple[str, ...] = ()  # what it is without its own size, at the same place
    # With one of these at one of the same joints, or with its own like anywhere, it is a single
    # mechanism that nobody listed.
    one_with: tuple[str, ...] = ()
    one_such_as: str = ""  # what both together may be instead
    covers: tuple[str, ...] = ()  # not told beside it: from posture to posture it looks like them
    covers_here: tuple[str, ...] = ()  # likewise, at the same place
    leaves_here: tuple[str, ...] = ()  # what its form leaves looks like them: not added beside it
    some_is_ordinary: bool = False  # a sound arm has some of it: the name is for what is more
    least_shared: float = 0.0  # mountings that must bring it: fewer may be badly aimed hits
    own_candidates: bool = False  # a look of its own seeks it: the common one finds it too late
    separate_minima: bool = (
        False  # candidates of one place are local minima of their own: each is fitted
    )
    ends_alike: bool = False  # of the two places it reaches between the tests tell the second
    told_by: str = ""  # which further test tells
    remedy: str = ""  # what to do in the lab now
    of_the_test: bool = False  # what was measured otherwise: the arm itself is as without it


class Builder(Protocol):
    """Adds an instance's terms to a posture's equations."""

    def __call__(self, assembly: Assembly, values: Mapping[str, float]) -> None:
        """Add them."""
        ...


class Describer(Protocol):
    """Says where and how an instance stands, in the arm file's words."""

    def __call__(self, values: Mapping[str, float]) -> dict[str, object]:
        """Return entries of a description."""
        ...


class InitialValues(Protocol):
    """Where else a fit with an instance begins, from the values of a model without it."""

    def __call__(self, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """Return values by name, all of them."""
        ...


class IsAlso(Protocol):
    """Tells whether another instance is the same thing, by the values of a fit."""

    def __call__(self, values: Mapping[str, float], other: Instance) -> bool:
        """Return whether it is."""
        ...


class Alternatives(Protocol):
    """What a fit with an instance may stand for: other instances, and where those begin."""

    def __call__(
        self, values: Mapping[str, float]
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        """Return instances with values by name, all of them."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Instance:
    """An effect at a place: at one joint, in one link, in one channel."""

    effect: EffectWords
    place: str
    ends_at: tuple[str, ...] = ()  # joints where it ends: what its form leaves, it leaves there too
    parameters: tuple[Parameter, ...] = ()
    relaxes: Mapping[str, Parameter] = field(default_factory=dict)  # by name: the wider prior
    builder: Builder | None = None
    describe: Describer | None = None
    initial_values: InitialValues | None = None
    alternatives: Alternatives | None = None
    is_also: IsAlso | None = None
    begins_at: tuple[str, ...] = ()  # parameters that count from where a description puts it
    details: tuple[str, ...] = ()  # parameters of its form: in files, but not told to people
    words: Mapping[str, str] = field(default_factory=dict)  # of parameters, where names do not do
    size: str = ""  # the parameter that says how large
    shapes: tuple[str, ...] = ()  # parameters that do nothing while the size is zero
    sizes: tuple[str, ...] = ()  # or the largest of several
    material: float = 0.0  # below this size it is not worth a name
    # Drives of whose compliance that is a part: ln k of each, and what is believed of it.
    drives: tuple[tuple[str, float], ...] = ()
    size_offset: float = 0.0  # of the size: what the null has anyway; only more is an effect
    pieces: str = ""  # how it cuts which link's mass: two ways of one link exclude each other
    # ln k of the joint whose compliance it is a part of, as long as nothing else of it is seen.
    hides_in: str = ""
    of_one_posture: bool = False  # nothing of it recurs in another
    last: bool = False  # built after the others: reads every coordinate they bring
    is_term: bool = False  # of the equations, though it only widens priors
    level_dependent: bool = False  # soft and hard hits of a posture are answered otherwise
    law: JointLaw | None = None  # of a joint, instead of terms
    about: Linearised | None = None  # where that is linearised, and on which lines
    is_line: bool = False  # a single hinge inside a link, and nothing else
    side_sizes: tuple[tuple[str, float], ...] = ()  # other parameters that would be material alone

    @property
    def title(self) -> str:
        """Return effect and place in words."""
        return f"{self.effect.title} ({self.place})" if self.place else self.effect.title

    @property
    def key(self) -> tuple[str, str]:
        """Return name and place."""
        return self.effect.name, self.place

    def relaxed(self, space: Space) -> tuple[Parameter, ...]:
        """Return the priors it widens, of those the space has."""
        return tuple(p for name, p in self.relaxes.items() if name in space.index)

    @property
    def unit(self) -> str:
        """Return the unit of its size; empty for a pure number."""
        every = (*self.parameters, *self.relaxes.values())
        return next((p.unit for p in every if p.name == self.size), "")

    @property
    def owned(self) -> tuple[str, ...]:
        """Return the names of all parameters it brings or frees."""
        return (*(p.name for p in self.parameters), *self.relaxes)

    @property
    def told(self) -> tuple[str, ...]:
        """Return the names of those that its description does not tell as a line."""
        return tuple(name for name in self.owned if name not in self.begins_at)

    def is_material(self, values: Mapping[str, float]) -> bool:
        """Return whether it is large enough to be worth a name, beside drives as they are."""
        names = self.sizes or ((self.size,) if self.size else ())
        if not names:
            return True
        if self.size_offset:
            largest = max(values[name] - self.size_offset for name in names)
        else:
            largest = max(abs(values[name]) for name in names)
        softer = [believed - values.get(name, believed) for name, believed in self.drives]
        times = float(np.exp(np.mean(softer or [0.0])))
        beside = any(abs(values[name]) >= least * times for name, least in self.side_sizes)
        return largest >= self.material * times or beside

    def excludes(self, other: Instance) -> bool:
        """Return whether one covers the other, or both cut one link's mass, but otherwise."""
        if self._covers(other) or other._covers(self):
            return True
        own, theirs = self.pieces.split(maxsplit=1), other.pieces.split(maxsplit=1)
        return own[1:] == theirs[1:] != [] and own[0] != theirs[0]

    def goes_with(self, others: Iterable[Instance]) -> bool:
        """Return whether it can be added to those that are there.

        It excludes none, has no parameter that one has, and is not what the form of one may leave
        at the same place or its ends.
        """
        names = {p.name for p in self.parameters}
        return not any(
            self.excludes(other)
            or any(p.name in names for p in other.parameters)
            or (
                self.place in (other.place, *other.ends_at)
                and self.effect.name in other.effect.leaves_here
            )
            for other in others
        )

    def _covers(self, other: Instance) -> bool:
        here = other.place == self.place and other.effect.name in self.effect.covers_here
        return here or other.effect.name in self.effect.covers

    def add(self, assembly: Assembly, values: Mapping[str, float]) -> None:
        """Add its terms."""
        if self.builder is not None:
            self.builder(assembly, values)
        if self.law is not None:
            assembly.multiply_spring(
                self.law.joint, values, *self._instead_of(self.law, assembly, values)
            )

    def linear_law(self, lines: PostureLines) -> LinearLaw | None:
        """Return what stands for the joint's law on some lines; None where that is not known."""
        return None if self.about is None else self.about.table.get(lines.key)

    def _instead_of(
        self, law: JointLaw, assembly: Assembly, values: Mapping[str, float]
    ) -> tuple[float, float]:
        """What a spring and a damper in a law's place add to ln k and ln c.

        Where nothing was hit: those of harmonic swings of the level.
        """
        here = self.linear_law(assembly.lines)
        if here is not None:
            return here.log_k, here.log_c
        return harmonic_spring(law, values, assembly.lines, assembly.geometry)
