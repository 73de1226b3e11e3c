"""Something on the arm that nobody told the model of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.assembly import Assembly, Inertial
from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain, unit
from armodal.hil_sim.truth import Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Payload"]

PAYLOAD = 0.035  # of the arm's mass
_ELEMENTS = ("xx", "yy", "xy", "xz", "yz")  # of its inertia beyond that of a ball


class Payload(BaseEffect):
    """A rigid body bolted to a link."""

    kind: Literal["payload"]
    link: str
    mass_kg: Positive
    center_m: Vector
    inertia_kg_m2: Annotated[tuple[float, ...], Field(strict=False, min_length=6, max_length=6)] = (
        0.0,
    ) * 6

    def assemble(self, assembly: Assembly) -> Assembly:
        """Add the body to the link's far end."""
        xx, xy, xz, yy, yz, zz = self.inertia_kg_m2
        extra = Inertial(
            mass_kg=self.mass_kg,
            center_m=np.array(self.center_m),
            inertia_kg_m2=np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        )
        segment = assembly.carrier_of(self.link)
        return assembly.replaced(segment.loaded(segment.inertial().joined(extra)))


def _of_file(own: FileEffect) -> Twin:
    """Its moments are about the link's centre."""
    place, mass = own.effect.place, own.sizes["payload"]
    center = next(j.link.center_m for j in own.arm.joints if j.link.name == place)
    moment = own.vector("payload_moment", place)
    even = mass * own.sizes.get("payload_radius_of_gyration", 0.0) ** 2
    xx, yy, xy, xz, yz = (own.sizes.get(f"payload_uneven_{at}", 0.0) for at in _ELEMENTS)
    body = np.array([[1.0 + xx, xy, xz], [xy, 1.0 + yy, yz], [xz, yz, 1.0 - xx - yy]])
    inertia = even * own.turned[place] @ body @ own.turned[place].T
    table = {
        "kind": "payload",
        "link": place,
        "mass_kg": mass,
        "center_m": tuple(own.turned[place] @ center + moment / mass),
        "inertia_kg_m2": tuple(inertia[np.triu_indices(3)].tolist()),
    }
    return Twin(tables=[table])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """On the last link or on the one that carries the wrist."""
    names = list(places.links)
    link = names[-1] if rng.random() < 0.6 else names[min(3, len(names) - 1)]
    arm_kg = sum(link["mass_kg"] for link in places.links.values())
    mass = float(PAYLOAD * arm_kg * magnitude * about(rng))
    center = np.array(places.links[link]["center_m"]) + 0.06 * unit(rng)
    own = 0.0018 * mass
    table = {
        "kind": "payload",
        "link": link,
        "mass_kg": mass,
        "center_m": plain(center),
        "inertia_kg_m2": (own, 0.0, 0.0, own, 0.0, own),
    }
    return hidden("payload", link, table, mass_kg=mass, center_m=places.in_file(link, center))


OF_FILE = {"payload": _of_file}
COMPARED = {"payload": told("mass_kg")}
HIDES = {"payload": Hides(hide=hide, since=1, sized=True, larger_on={"bench57": 10.0, "ur5": 2.5})}
