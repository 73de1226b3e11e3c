"""A damper between two links, or a link and the floor: damping that follows no stiffness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive, Vector
from armodal.protocols.errors import PlantError

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Dashpot"]

DASHPOT = 2.0  # about the joints between its ends, of their mean damping


class Dashpot(BaseEffect):
    """It resists the rate at which the distance of its ends changes; `from_link` may be "floor".

    On the floor the place is in the base frame.
    """

    kind: Literal["dashpot"]
    from_link: str
    from_m: Vector
    to_link: str
    to_m: Vector
    damping_n_s_per_m: Positive

    def act(self, terms: LinearTerms) -> None:
        """Add c row^T row.

        Raises
        ------
        PlantError
            If both ends meet in the posture.
        """
        start, v_start = terms.end_of(self.from_link, np.array(self.from_m))
        end, v_end = terms.end_of(self.to_link, np.array(self.to_m))
        length = float(np.linalg.norm(end - start))
        if length < 1e-6:
            raise PlantError(
                f"effects: the dashpot from {self.from_link} to {self.to_link} has no length in "
                "this posture; move one of its ends"
            )
        row = (end - start) / length @ (v_end - v_start)
        terms.spring(row[None, :], 0.0, self.damping_n_s_per_m)


def _of_file(own: FileEffect) -> Twin:
    start, _, end = own.effect.place.partition(" and ")
    table = {
        "kind": "dashpot",
        "from_link": start,
        "from_m": tuple(own.vector("damper_from", "base" if start == "floor" else start)),
        "to_link": end,
        "to_m": tuple(own.vector("damper_to", end)),
        "damping_n_s_per_m": own.sizes["damper"],
    }
    return Twin(tables=[table])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A damper from the floor or the first link to a link beyond the second joint."""
    names = list(places.links)
    near = "floor" if rng.random() < 0.5 else names[0]
    far = names[int(rng.integers(2, 4))]
    first = places.reach(names[1])
    lever = 0.65 * float(np.linalg.norm(first))
    joints = [places.joints[name]["damping_n_m_s_per_rad"] for name in places.elastic[:3]]
    damping = float(DASHPOT * magnitude * about(rng) * np.mean(joints) / lever**2)
    from_m = (0.22, 0.28, 0.12) if near == "floor" else plain(places.somewhere(rng, near))
    to_m = plain(places.somewhere(rng, far))
    table = {
        "kind": "dashpot",
        "from_link": near,
        "from_m": from_m,
        "to_link": far,
        "to_m": to_m,
        "damping_n_s_per_m": damping,
    }
    return hidden(
        "nonproportional",
        [near, far],
        table,
        damping_n_s_per_m=damping,
        from_m=list(from_m) if near == "floor" else places.in_file(near, from_m),
        to_m=places.in_file(far, to_m),
    )


OF_FILE = {"nonproportional": _of_file}
COMPARED = {"nonproportional": told("damping_n_s_per_m")}
HIDES = {"nonproportional": Hides(hide=hide, since=2, sized=True)}
