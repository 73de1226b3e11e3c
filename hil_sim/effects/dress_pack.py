"""A dress pack: a mass that hangs on a link by springs; outside the first library."""

from __future__ import annotations

from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect, Weight
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Positive, Vector

__all__ = ["DressPack"]


class DressPack(BaseEffect):
    """A point mass that moves in three ways against a point of a link, held by equal springs.

    Its weight hangs on that point at rest.
    """

    kind: Literal["dress_pack"]
    link: str
    position_m: Vector
    mass_kg: Positive
    frequency_hz: Positive  # of the mass on its springs, link at rest
    damping_ratio: NotNegative

    def coordinates(self) -> tuple[str, ...]:
        """Motion of the mass along x, y and z of the base frame."""
        return tuple(f"dress pack on {self.link} {axis}" for axis in "xyz")

    def weights(self) -> tuple[Weight, ...]:
        """The whole of it hangs on the link."""
        return (Weight(link=self.link, position_m=np.array(self.position_m), mass_kg=self.mass_kg),)

    def act(self, terms: LinearTerms) -> None:
        """Add the mass and its springs."""
        w = 2.0 * np.pi * self.frequency_hz
        rows = -terms.motion_of(self.link, np.array(self.position_m))[:3]
        for i, label in enumerate(self.coordinates()):
            own = terms.index(label)
            rows[i, own] += 1.0
            terms.M[own, own] += self.mass_kg
        terms.spring(rows, self.mass_kg * w**2, 2.0 * self.damping_ratio * self.mass_kg * w)
