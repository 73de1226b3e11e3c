"""What an effect may do to the arm: cut the chain, load the equations, spoil the record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.assembly import Assembly
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Truth

__all__ = ["BaseEffect", "Weight", "with_point_matrix"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Weight:
    """A weight that a link carries at rest without sharing its motion."""

    link: str
    position_m: Array
    mass_kg: float


class BaseEffect(Truth):
    """A table of `[[effects]]`; whatever an effect does not do stays as it is here."""

    winds_springs: ClassVar[bool] = False  # changes what others find a spring stretched by

    def assemble(self, assembly: Assembly) -> Assembly:
        """Change bodies, hinges and their springs."""
        return assembly

    def coordinates(self) -> tuple[str, ...]:
        """Names of degrees of freedom that are no hinges of the chain."""
        return ()

    def weights(self) -> tuple[Weight, ...]:
        """What hangs on the chain at rest."""
        return ()

    def act(self, terms: LinearTerms) -> None:
        """Add terms to the equations of a held posture."""

    def sense(self, sensing: Sensing) -> Sensing:
        """Change what is recorded."""
        return sensing


def with_point_matrix(sensing: Sensing, points: tuple[str, ...], matrix: Array) -> Sensing:
    """Record `matrix` times the accelerations at some points, or at all if none is named."""
    if not points:
        return replace(sensing, everywhere=matrix @ sensing.everywhere)
    at_point = dict(sensing.at_point)
    for point in points:
        at_point[point] = matrix @ at_point.get(point, np.eye(3))
    return replace(sensing, at_point=at_point)
