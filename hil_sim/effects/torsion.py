"""A link that twists all along."""

from __future__ import annotations

from typing import Literal

from armodal.hil_sim.assembly import Assembly
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.sliced_link import SlicedLink, slices_of_file
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "Torsion"]

_WORD = "twist"  # in the names of its hinges


class Torsion(SlicedLink):
    """Pieces hinged about the line; with GJ n / L at each of n cuts the whole link has GJ / L."""

    kind: Literal["torsion"]
    torsional_stiffness_n_m2: Positive

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link along its line, again and again."""
        return self.hinged(assembly, (self.torsional_stiffness_n_m2,), (self.along,), _WORD)


def _of_file(own: FileEffect) -> Twin:
    return slices_of_file(own, "torsion", "torsional_stiffness_n_m2", _WORD)


OF_FILE = {"link_torsion": _of_file}
