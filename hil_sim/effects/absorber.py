"""A mass on a spring and a damper on a link: a loose cover, a box on its brackets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain, unit, within
from armodal.hil_sim.effects.hung import Hung
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

PART, SPANS = 0.03, {"frequency_hz": (7.0, 55.0), "damping_ratio": (0.015, 0.12)}  # of all mass


class Absorber(Hung):
    """It slides along `direction`; across that a part of it moves with the link."""

    kind: Literal["absorber"]
    direction: Vector
    across: NotNegative = 1.0

    def act(self, terms: LinearTerms) -> None:
        """Add the mass, its spring and its damper."""
        own = terms.index(self.coordinates()[0])
        u = self.towards(terms, np.array(self.direction))
        v = terms.motion_of(self.link, np.array(self.position_m))[:3]
        terms.M = terms.M + self.across * self.mass_kg * v.T @ (np.eye(3) - np.outer(u, u)) @ v
        terms.M[own, own] += self.mass_kg
        self.span(terms, (np.eye(len(terms.labels))[own] - u @ v)[None])


def _of_file(own: FileEffect) -> Twin:
    at, u = own.line()
    keys = ("mass", "ln_frequency", "loss", "part_across", "place_along")
    mass, ln_hz, loss_s, across, along = (own.sizes[f"absorber_{key}"] for key in keys)
    hz = float(np.exp(ln_hz))
    tuned = {"mass_kg": mass, "frequency_hz": hz, "damping_ratio": np.pi * hz * loss_s}
    where = {"position_m": plain(at + along * u), "direction": plain(u), "across": across}
    return Twin(tables=[{"kind": "absorber", "link": own.effect.place, **where, **tuned}])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """On a link from the second on."""
    link = str(rng.choice([*places.links][1:]))
    mass = float(PART * magnitude * about(rng) * sum(x["mass_kg"] for x in places.links.values()))
    own = {"mass_kg": mass} | {key: within(rng, span) for key, span in SPANS.items()}
    where = {"position_m": plain(places.somewhere(rng, link)), "direction": plain(unit(rng))}
    return hidden("absorber", link, {"kind": "absorber", "link": link, **where, **own}, **own)


OF_FILE = {"absorber": _of_file}
COMPARED = {"absorber": told("mass_kg")}
HIDES = {"absorber": Hides(hide=hide, since=3, sized=True)}
