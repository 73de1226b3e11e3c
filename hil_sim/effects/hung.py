"""What hangs on a link by equal springs."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.effects.effect import BaseEffect, Weight
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Positive, Vector

__all__ = ["Hung"]

Array = npt.NDArray[np.float64]


class Hung(BaseEffect):
    """A point mass at rest at a place of a link, which carries its weight there."""

    link: str
    position_m: Vector
    mass_kg: Positive
    frequency_hz: Positive  # of the mass on its springs, link at rest
    damping_ratio: NotNegative

    def coordinates(self) -> tuple[str, ...]:
        """Motion of the mass against the floor."""
        return (f"{type(self).__name__.lower()} on {self.link}",)

    def weights(self) -> tuple[Weight, ...]:
        """The whole of it hangs on the link."""
        return (Weight(link=self.link, position_m=np.array(self.position_m), mass_kg=self.mass_kg),)

    def towards(self, terms: LinearTerms, direction: Array) -> Array:
        """Unit direction (3,) in the base's frame of one in the link's."""
        R = terms.at.R[terms.bodies[terms.carrier[self.link]]]
        return np.asarray(R @ direction / np.linalg.norm(direction))

    def span(self, terms: LinearTerms, rows: Array) -> None:
        """Span a spring and its damper along each row (k, n) of the coordinates."""
        w = 2.0 * np.pi * self.frequency_hz
        terms.spring(rows, self.mass_kg * w**2, 2.0 * self.damping_ratio * self.mass_kg * w)
