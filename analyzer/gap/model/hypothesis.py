"""A hypothesis: the ordinary model, and the effects that are said to be there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Space

__all__ = ["Hypothesis"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """Instances of effects on top of the ordinary model; none is the null."""

    ordinary: Ordinary
    instances: tuple[Instance, ...] = ()

    @property
    def name(self) -> str:
        """Return what is said to be there, in words."""
        return " + ".join(instance.title for instance in self.instances) or "nothing missing"

    @property
    def level_dependent(self) -> bool:
        """Return whether soft and hard hits of a posture are answered otherwise."""
        return any(instance.level_dependent for instance in self.instances)

    @property
    def has_laws(self) -> bool:
        """Return whether a joint has a law of its own."""
        return any(instance.law is not None for instance in self.instances)

    def without_points(self) -> Hypothesis:
        """Return it with its laws linearised nowhere: a fit does so where it begins."""
        return replace(self, instances=tuple(replace(i, about=None) for i in self.instances))

    def space(self) -> Space:
        """Return all parameters."""
        space = Space(self.ordinary.parameters())
        for instance in self.instances:
            space = space.with_changes(
                {p.name: p for p in instance.relaxed(space)}, instance.parameters
            )
        return space

    def add_to(self, ordinary: Assembly, values: Mapping[str, float]) -> Assembly:
        """Return a posture's equations with the effects; the ordinary ones stay as they are."""
        if not self.instances:
            return ordinary
        assembly = ordinary.copied()
        for instance in sorted(self.instances, key=lambda instance: instance.last):
            instance.add(assembly, values)
        return assembly
