"""What a case hides: tables for the plant file, the truth about them, and how both are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Hidden", "about", "hidden", "loss_s", "plain", "unit", "within"]

Array = npt.NDArray[np.float64]

LOSS_S = (5e-6, 1.5e-4)  # damping / stiffness


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """What is hidden: tables for the plant file, and the truth in the field's words."""

    tables: list[dict[str, Any]]
    name: str
    place: Any  # joint, link, point or a list of them
    parameters: dict[str, Any]
    size: float | None = None  # in what the gap library tells it by, where that is known

    def truth(self) -> dict[str, Any]:
        """Name, place and parameters."""
        told = {"name": self.name, "place": self.place, "parameters": self.parameters}
        return told if self.size is None else told | {"size": self.size}


def hidden(
    name: str, place: Any, table: dict[str, Any], *, size: float | None = None, **parameters: Any
) -> Hidden:
    """One effect of one table."""
    return Hidden(tables=[table], name=name, place=place, parameters=parameters, size=size)


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
