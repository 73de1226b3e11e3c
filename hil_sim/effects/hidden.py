"""What a case hides: tables for the plant file, the truth about them, and how both are drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = [
    "Hidden",
    "Hides",
    "about",
    "all_or_one_point",
    "hidden",
    "loss_s",
    "plain",
    "unit",
    "within",
]

Array = npt.NDArray[np.float64]

LOSS_S = (5e-6, 1.5e-4)  # damping / stiffness


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """What is hidden: tables for the plant file, and the truth in the field's words."""

    tables: list[dict[str, Any]]
    name: str
    place: Any  # joint, link, point or a list of them
    parameters: dict[str, Any]

    def truth(self) -> dict[str, Any]:
        """Name, place and parameters."""
        return {"name": self.name, "place": self.place, "parameters": self.parameters}


@dataclass(frozen=True, slots=True, kw_only=True)
class Hides:
    """How an effect is hidden in a case.

    hide : what is hidden, at its clear size times a magnitude
    since : version of the library it came with; 0: outside every library
    sized : whether its clear size is found case by case; else it is that of `hide`, as of what
        moves weak modes too far for the search, which follows its first sensitivities
    placed : drawn where the channel moves enough to tell
    apart_from : effects that it never stands beside
    larger_on : times the size that is found, by arm: what tolerances of masses hide is more than
        the search's refit takes off. With these the held-out error of an analysis without the
        effect is about three times that of one with it
    """

    hide: Callable[[ArmPlaces, np.random.Generator, float], Hidden]
    since: int
    sized: bool = False
    placed: bool = False
    apart_from: tuple[str, ...] = ()
    larger_on: Mapping[str, float] = field(default_factory=dict)


def hidden(name: str, place: Any, table: dict[str, Any], **parameters: Any) -> Hidden:
    """One effect of one table."""
    return Hidden(tables=[table], name=name, place=place, parameters=parameters)


def about(rng: np.random.Generator) -> float:
    """A size within a sixth of the nominal one."""
    return float(np.exp(rng.uniform(-0.15, 0.15)))


def loss_s(rng: np.random.Generator) -> float:
    """Damping over stiffness of something soft, drawn evenly by its logarithm."""
    return within(rng, LOSS_S)


def within(rng: np.random.Generator, span: tuple[float, float]) -> float:
    """A number of a span, drawn evenly by its logarithm."""
    return float(np.exp(rng.uniform(*np.log(span))))


def unit(rng: np.random.Generator) -> Array:
    """A direction, all alike."""
    v = rng.standard_normal(3)
    result: Array = v / np.linalg.norm(v)
    return result


def plain(vector: npt.ArrayLike) -> tuple[float, ...]:
    """Numbers as a plant file has them."""
    return tuple(float(value) for value in np.asarray(vector))


def all_or_one_point(
    places: ArmPlaces, rng: np.random.Generator, magnitude: float
) -> tuple[str, ...]:
    """All points when clear; else one on a moving link."""
    if magnitude >= 1.0:
        return ()
    moving = [p["id"] for name in places.structural() for p in places.points[name]]
    return (str(rng.choice(moving)),)
