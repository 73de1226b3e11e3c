"""A damper between two links, or a link and the floor: damping that follows no stiffness."""

from __future__ import annotations

from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive, Vector
from armodal.protocols.errors import PlantError

__all__ = ["OF_FILE", "Dashpot"]


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


OF_FILE = {"nonproportional": _of_file}
