"""A link that bends all along."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from armodal.hil_sim.assembly import Assembly
from armodal.hil_sim.effects.bearing import across
from armodal.hil_sim.effects.compared import Compared
from armodal.hil_sim.effects.from_file import FileEffect, Twin, three
from armodal.hil_sim.effects.hidden import Hidden, Hides, plain, unit
from armodal.hil_sim.effects.sliced_link import (
    SlicedLink,
    all_along,
    slices_of_file,
    yield_per_length,
)
from armodal.hil_sim.truth import Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Bending"]

_WORD = "bend"  # in the names of its hinges

BENDING = 0.15  # of the arm's own joint compliance, the whole link
FLATTEST = 4.0  # at most, about one direction over the other: a thin box 0.4 as wide as high


class Bending(SlicedLink):
    """Pieces hinged both ways across the line.

    With EI n / L at each of n cuts the tip of a cantilever gives L^3 / 3 EI (1 - 1 / 4 n^2). The
    stiffness told is that of the mean yield about two directions across.
    """

    kind: Literal["bending"]
    bending_stiffness_n_m2: Positive
    softest_about: Vector | None = None  # across the line; None: as soft about all
    softest_over_stiffest: Annotated[float, Field(ge=1.0)] = 1.0

    @model_validator(mode="after")
    def _is_softest_across(self) -> Self:
        if self.softest_about is not None and not np.cross(self.along, self.softest_about).any():
            raise ValueError("softest_about must not lie along the link's line")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link across its line, again and again."""
        directions = across(self.along)
        if self.softest_about is not None:
            soft = np.array(self.softest_about)
            soft = soft - self.along * (self.along @ soft)
            soft /= np.linalg.norm(soft)
            directions = soft, np.cross(self.along, soft)
        first, second = _softer(self.softest_over_stiffest)
        k = self.bending_stiffness_n_m2
        return self.hinged(assembly, (k / first, k / second), directions, _WORD)


def _softer(ratio: float) -> tuple[float, float]:
    """Yields about both directions over their mean."""
    return 2.0 * ratio / (1.0 + ratio), 2.0 / (1.0 + ratio)


def _of_file(own: FileEffect) -> Twin:
    told, more, ratio = own.effect.description, {}, 1.0
    if "softest_about" in told:
        ratio = float(str(told["softest_over_stiffest"]))
        about = own.turned[own.effect.place] @ three(told["softest_about"])
        more = {"softest_about": tuple(about), "softest_over_stiffest": ratio}
    return slices_of_file(own, "bending", "bending_stiffness_n_m2", _WORD, _softer(ratio), **more)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A long link that bends all along, more easily about one direction than about the other."""
    made = all_along("bending", "bending_stiffness_n_m2", BENDING * magnitude, places, rng)
    table = {
        **made.tables[0],
        "softest_about": plain(unit(rng)),
        "softest_over_stiffest": float(np.exp(rng.uniform(0.0, np.log(FLATTEST)))),
    }
    return replace(made, tables=[table])


OF_FILE = {"link_bending": _of_file}
COMPARED = {"link_bending": Compared(size=partial(yield_per_length, "bending_stiffness_n_m2"))}
HIDES = {"link_bending": Hides(hide=hide, since=2, apart_from=("link_torsion", "link_axis"))}
