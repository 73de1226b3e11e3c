"""Every effect the workflow knows: the modules of `analyzer.gap.effects` and what they offer.

A module may offer, each found by its name,

    instances(ordinary)                       the effect at every place of an arm
    linear_candidates(stage, fit, instances)  candidates by a linear look of its own
    channel_candidates(stage, hypothesis, values)  likewise, of what was measured
    of_file(ordinary, description)            the instance an arm file describes
    laws(ordinary, joint, swing_rad, rate_rad_s)  a joint's own laws, by its swing under a hit
    at_line(ordinary, link, direction, point) the instance along a line of a link; of a file, too
    together(ordinary, one, other)            the one instance that two are
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from functools import lru_cache
from types import ModuleType
from typing import Any

from armodal.analyzer.gap import effects
from armodal.analyzer.gap.effects.own_law import law_of_file
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.lines_in_links import described_line
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = [
    "all_instances",
    "described",
    "hooks",
    "instances_named",
    "names_of_laws",
    "title_of",
    "together",
]


@lru_cache(maxsize=8)  # of an arm and its postures; asked for in every round
def all_instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Return every effect at every place of an arm where it may be."""
    return tuple(instance for make in hooks("instances") for instance in make(ordinary))


def instances_named(ordinary: Ordinary, name: str) -> tuple[Instance, ...]:
    """Return the effect of that name at every place; much sooner than every effect there is."""
    every = (
        instance
        for module in _modules()
        if name in _names(module) and hasattr(module, "instances")
        for instance in module.instances(ordinary)
    )
    return tuple(instance for instance in every if instance.effect.name == name)


def hooks(name: str) -> tuple[Any, ...]:
    """Return the functions of that name which effects offer."""
    return tuple(getattr(module, name) for module in _modules() if hasattr(module, name))


def described(ordinary: Ordinary, name: str, description: Mapping[str, object]) -> Instance | None:
    """Return the instance of an effect that stands where an arm file's description tells."""
    for module in _modules():
        if name in _names(module) and hasattr(module, "laws"):
            return law_of_file(module.laws, ordinary, description)
        if name in _names(module) and hasattr(module, "of_file"):
            found: Instance | None = module.of_file(ordinary, description)
            return found
        if name in _names(module) and hasattr(module, "at_line"):
            line = described_line(ordinary, description)
            along: Instance | None = None if line is None else module.at_line(ordinary, *line)
            return along
    return None


def names_of_laws() -> tuple[str, ...]:
    """Return the names of effects that are a joint's own laws."""
    return tuple(module.WORDS.name for module in _modules() if hasattr(module, "laws"))


def together(ordinary: Ordinary, one: Instance, other: Instance) -> Instance | None:
    """Return the one instance that two are; None where they are two."""
    every = (of(ordinary, one, other) for of in hooks("together"))
    return next((both for both in every if both is not None), None)


def title_of(name: str) -> str:
    """Return an effect's title; its name where the library has none of that name."""
    titles = (
        words.title
        for module in _modules()
        for words in vars(module).values()
        if isinstance(words, EffectWords) and words.name == name
    )
    return next(titles, name)


@lru_cache(maxsize=1)
def _modules() -> tuple[ModuleType, ...]:
    listed = pkgutil.iter_modules(effects.__path__)
    return tuple(importlib.import_module(f"{effects.__name__}.{m.name}") for m in listed)


def _names(module: ModuleType) -> set[str]:
    return {words.name for words in vars(module).values() if isinstance(words, EffectWords)}
