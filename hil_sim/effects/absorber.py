"""A mass on a spring and a damper on a link: a loose cover, a box on its brackets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect, Weight
from armodal.hil_sim.effects.hidden import Hidden, about, plain, unit, within
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

SINCE, SIZED = 3, True  # version of the library
PART, HERTZ, RATIO = 0.03, (7.0, 55.0), (0.015, 0.12)  # part of the arm's mass


class Absorber(BaseEffect):
    """It slides along `direction`; across that it moves with the link, which carries its weight."""

    kind: Literal["absorber"]
    link: str
    position_m: Vector
    direction: Vector
    mass_kg: Positive
    frequency_hz: Positive  # of the mass on its spring, link at rest
    damping_ratio: NotNegative

    def coordinates(self) -> tuple[str, ...]:
        """Motion of the mass along its direction, against the floor."""
        return (f"absorber on {self.link}",)

    def weights(self) -> tuple[Weight, ...]:
        """The whole of it hangs on the link."""
        return (Weight(link=self.link, position_m=np.array(self.position_m), mass_kg=self.mass_kg),)

    def act(self, terms: LinearTerms) -> None:
        """Add the mass, its spring and its damper."""
        w, own = 2.0 * np.pi * self.frequency_hz, terms.index(self.coordinates()[0])
        R = terms.at.R[terms.bodies[terms.carrier[self.link]]]
        u = R @ np.array(self.direction) / np.linalg.norm(self.direction)
        v = terms.motion_of(self.link, np.array(self.position_m))[:3]
        terms.M = terms.M + self.mass_kg * v.T @ (np.eye(3) - np.outer(u, u)) @ v
        terms.M[own, own] += self.mass_kg
        row = np.eye(len(terms.labels))[own] - u @ v
        terms.spring(row[None], self.mass_kg * w**2, 2.0 * self.damping_ratio * self.mass_kg * w)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """On a link from the second on."""
    link = str(rng.choice([*places.links][1:]))
    mass = float(PART * magnitude * about(rng) * sum(x["mass_kg"] for x in places.links.values()))
    hz, ratio = within(rng, HERTZ), within(rng, RATIO)
    told = {"mass_kg": mass, "frequency_hz": hz, "damping_ratio": ratio}
    where = {"position_m": plain(places.somewhere(rng, link)), "direction": plain(unit(rng))}
    table = {"kind": "absorber", "link": link, **where, **told}
    return Hidden(tables=[table], name="absorber", place=link, parameters=told, size=mass)
