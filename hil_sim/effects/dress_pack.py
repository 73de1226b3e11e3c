"""A dress pack: a mass that hangs on a link by springs; outside the first library."""

from __future__ import annotations

from typing import Literal

import numpy as np

from armodal.hil_sim.effects.hung import Hung
from armodal.hil_sim.linear import LinearTerms

__all__ = ["DressPack"]


class DressPack(Hung):
    """A point mass that moves in three ways against a point of a link, held by equal springs."""

    kind: Literal["dress_pack"]

    def coordinates(self) -> tuple[str, ...]:
        """Motion of the mass along x, y and z of the base frame."""
        return tuple(f"dress pack on {self.link} {axis}" for axis in "xyz")

    def act(self, terms: LinearTerms) -> None:
        """Add the mass and its springs."""
        rows = -terms.motion_of(self.link, np.array(self.position_m))[:3]
        for i, label in enumerate(self.coordinates()):
            own = terms.index(label)
            rows[i, own] += 1.0
            terms.M[own, own] += self.mass_kg
        self.span(terms, rows)
