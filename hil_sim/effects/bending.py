"""A link that bends all along."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from hil_sim.assembly import Assembly, Spring
from hil_sim.effects.bearing import across
from hil_sim.effects.effect import BaseEffect
from hil_sim.pieces import sliced
from hil_sim.truth import NotNegative, Positive, Vector

__all__ = ["Bending"]


class Bending(BaseEffect):
    """A link as rigid pieces along a line, each hinged to the one before it both ways across.

    The bending stiffness EI is spread over n cuts, EI n / L each, in the middles of n equal
    lengths: the tip of a cantilever gives L^3 / 3 EI (1 - 1 / 4 n^2).
    """

    kind: Literal["bending"]
    link: str
    from_m: Vector
    to_m: Vector
    cuts: Annotated[int, Field(ge=1, le=12)] = 3
    bending_stiffness_n_m2: Positive
    loss: NotNegative  # damping / stiffness, s

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if np.allclose(self.from_m, self.to_m):
            raise ValueError("from_m and to_m must differ")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link across its line, again and again."""
        start, end = np.array(self.from_m), np.array(self.to_m)
        length = float(np.linalg.norm(end - start))
        k = self.bending_stiffness_n_m2 * self.cuts / length
        return sliced(
            assembly,
            self.link,
            (start, end),
            self.cuts,
            across((end - start) / length),
            Spring(k=k, c=k * self.loss),
            "bend",
        )
