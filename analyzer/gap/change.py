"""What a parameter's step changes in the equations of several postures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import System

__all__ = ["Change"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Difference of two systems over a parameter's step; None where nothing changes."""

    mass: Array | None = None
    damping: Array | None = None
    stiffness: Array | None = None
    loss: Array | None = None
    moved: Array | None = None
    seen: Array | None = None
    tilted: Array | None = None
    mix: Array | None = None
    hit: Array | None = None
    force: Array | None = None
    sensor_mass_kg: Array | None = None

    @classmethod
    def between(cls, before: System, after: System, step: float) -> Change:
        """Change a unit of the parameter makes."""
        found: dict[str, Any] = {}
        for name in cls.__slots__:
            old, new = getattr(before, name), getattr(after, name)
            if not np.array_equal(old, new):
                found[name] = (new - old) / step
        return cls(**found)
