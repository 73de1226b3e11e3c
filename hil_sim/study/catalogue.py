"""Every effect that a case can hide, by the name that a verdict should give it.

Those of `hil_sim.effects` are found by themselves: a module's `HIDES` says by name how it hides
them (`hil_sim/effects/hidden.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from armodal.hil_sim.effects import modules_with
from armodal.hil_sim.effects.hidden import Hidden, Hides
from armodal.hil_sim.study.places import ArmPlaces
from armodal.protocols.errors import PlantError

__all__ = [
    "HIDES",
    "LIBRARY",
    "MAGNITUDES",
    "OUTSIDE",
    "VERSION",
    "Maker",
    "library",
    "stand_apart",
]

Maker = Callable[[ArmPlaces, np.random.Generator, float], Hidden]

MAGNITUDES = {"clear": 1.0, "medium": 0.5, "faint": 0.25}

HIDES: Mapping[str, Hides] = {
    name: hides
    for module in modules_with("HIDES").values()
    for name, hides in sorted(module.HIDES.items())
}

LIBRARY: dict[str, Maker] = {name: own.hide for name, own in HIDES.items() if own.since}

OUTSIDE: dict[str, Maker] = {name: own.hide for name, own in HIDES.items() if not own.since}

VERSION = max(own.since for own in HIDES.values())
"""The newest version of the library."""


def library(version: int) -> tuple[str, ...]:
    """Return the effects of a version: a study of it is drawn alike whatever came later.

    Raises
    ------
    PlantError
        If there is no such version.
    """
    if not 1 <= version <= VERSION:
        raise PlantError(f"library {version}: wanted a version from 1 to {VERSION}; give one")
    return tuple(name for name in LIBRARY if HIDES[name].since <= version)


def stand_apart(one: str, other: str) -> bool:
    """Whether two effects are never hidden together."""
    return one == other or other in HIDES[one].apart_from or one in HIDES[other].apart_from
