"""What a link that bends and one that twists have in common: a line, cuts and a loss."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.pieces import sliced
from armodal.hil_sim.truth import NotNegative, Vector

__all__ = ["SlicedLink", "slices_of_file"]

Array = npt.NDArray[np.float64]


class SlicedLink(BaseEffect):
    """A link as rigid pieces along a line, each hinged to the one before it.

    A stiffness per length is spread over n cuts, stiffness n / L each, in the middles of n equal
    lengths.
    """

    link: str
    from_m: Vector
    to_m: Vector
    cuts: Annotated[int, Field(ge=1, le=12)] = 3
    loss: NotNegative  # damping / stiffness, s

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if np.allclose(self.from_m, self.to_m):
            raise ValueError("from_m and to_m must differ")
        return self

    @property
    def along(self) -> Array:
        """Return (3,) the unit vector of the line."""
        line = np.array(self.to_m) - np.array(self.from_m)
        return np.asarray(line / np.linalg.norm(line))

    def hinged(
        self, assembly: Assembly, stiffness_n_m2: float, directions: tuple[Array, ...], word: str
    ) -> Assembly:
        """Cut the link again and again, by a hinge along each direction."""
        start, end = np.array(self.from_m), np.array(self.to_m)
        k = stiffness_n_m2 * self.cuts / float(np.linalg.norm(end - start))
        spring = Spring(k=k, c=k * self.loss)
        return sliced(assembly, self.link, (start, end), self.cuts, directions, spring, word)


def slices_of_file(own: FileEffect, kind: str, stiffness: str) -> Twin:
    """A link that bends or twists along the line to the next joint."""
    names = [joint.link.name for joint in own.arm.joints]
    link = own.effect.place
    at = names.index(link)
    if at + 1 == len(names):
        raise KeyError("a joint behind it")
    to = own.turned[link] @ np.asarray(own.arm.joints[at + 1].T_parent_joint[:3, 3])
    table = {
        "kind": kind,
        "link": link,
        "from_m": (0.0, 0.0, 0.0),
        "to_m": tuple(to),
        "loss": own.sizes.get(f"{kind}_loss", 0.0),
        stiffness: 1.0 / own.sizes[f"{kind}_compliance"],
    }
    return Twin(tables=[table])
