"""A dress pack: a mass that hangs on a link by springs; outside the first library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain
from armodal.hil_sim.effects.hung import Hung
from armodal.hil_sim.linear import LinearTerms

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "DressPack"]

PACK = 0.045  # of the arm's mass


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A hanging bundle of hoses."""
    link = list(places.links)[2 if rng.random() < 0.5 else 3]
    arm_kg = sum(link["mass_kg"] for link in places.links.values())
    mass = float(PACK * arm_kg * magnitude * about(rng))
    hertz = float(rng.uniform(9.0, 40.0))
    table = {
        "kind": "dress_pack",
        "link": link,
        "position_m": plain(places.somewhere(rng, link)),
        "mass_kg": mass,
        "frequency_hz": hertz,
        "damping_ratio": float(rng.uniform(0.04, 0.15)),
    }
    return hidden("dress_pack", link, table, mass_kg=mass, frequency_hz=hertz)


HIDES = {"dress_pack": Hides(hide=hide, since=0, sized=True)}
