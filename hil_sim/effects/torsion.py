"""A link that twists all along."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.assembly import Assembly
from armodal.hil_sim.effects.compared import Compared
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides
from armodal.hil_sim.effects.sliced_link import (
    SlicedLink,
    all_along,
    slices_of_file,
    yield_per_length,
)
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Torsion"]

_WORD = "twist"  # in the names of its hinges

TORSION = 0.8  # of the arm's own joint compliance, the whole link


class Torsion(SlicedLink):
    """Pieces hinged about the line; with GJ n / L at each of n cuts the whole link has GJ / L."""

    kind: Literal["torsion"]
    torsional_stiffness_n_m2: Positive

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link along its line, again and again."""
        return self.hinged(assembly, (self.torsional_stiffness_n_m2,), (self.along,), _WORD)


def _of_file(own: FileEffect) -> Twin:
    return slices_of_file(own, "torsion", "torsional_stiffness_n_m2", _WORD)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A long link that twists all along."""
    return all_along("torsion", "torsional_stiffness_n_m2", TORSION * magnitude, places, rng)


OF_FILE = {"link_torsion": _of_file}
COMPARED = {"link_torsion": Compared(size=partial(yield_per_length, "torsional_stiffness_n_m2"))}
HIDES = {"link_torsion": Hides(hide=hide, since=2, sized=True, apart_from=("link_axis",))}
