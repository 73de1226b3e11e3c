"""A link that bends all along."""

from __future__ import annotations

from typing import Literal

from armodal.hil_sim.assembly import Assembly
from armodal.hil_sim.effects.bearing import across
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.sliced_link import SlicedLink, slices_of_file
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "Bending"]

_WORD = "bend"  # in the names of its hinges


class Bending(SlicedLink):
    """Pieces hinged both ways across the line.

    With EI n / L at each of n cuts the tip of a cantilever gives L^3 / 3 EI (1 - 1 / 4 n^2).
    """

    kind: Literal["bending"]
    bending_stiffness_n_m2: Positive

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link across its line, again and again."""
        return self.hinged(assembly, self.bending_stiffness_n_m2, across(self.along), _WORD)


def _of_file(own: FileEffect) -> Twin:
    return slices_of_file(own, "bending", "bending_stiffness_n_m2", _WORD, ways=2)


OF_FILE = {"link_bending": _of_file}
