"""A link that bends: outside the first library."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from hil_sim.assembly import Assembly, Inertial, Spring
from hil_sim.effects.bearing import across
from hil_sim.effects.effect import BaseEffect
from hil_sim.newton_euler import skew
from hil_sim.truth import NotNegative, Positive, Vector

__all__ = ["Bending"]


class Bending(BaseEffect):
    """A link as equal rigid pieces along a line, each hinged to the one before it both ways across.

    The bending stiffness EI in N m2 is spread over the cuts: with length L and n pieces each of
    the n - 1 cuts has EI (n - 1) / L. Unbent, the pieces have together the mass, centre and
    inertia of the link. A test point rides on the piece it stands beside.
    """

    kind: Literal["bending"]
    link: str
    from_m: Vector
    to_m: Vector
    pieces: Annotated[int, Field(ge=2, le=12)] = 4
    bending_stiffness_n_m2: Positive
    loss: NotNegative  # damping / stiffness, s

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if np.allclose(self.from_m, self.to_m):
            raise ValueError("from_m and to_m must differ")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link across its line, again and again."""
        near = assembly.carrier_of(self.link)
        start, end = np.array(self.from_m), np.array(self.to_m)
        length = float(np.linalg.norm(end - start))
        axis = (end - start) / length
        parts = _pieces(near.inertial(), axis, length, self.pieces)
        k = self.bending_stiffness_n_m2 * (self.pieces - 1) / length
        assembly = assembly.replaced(near.loaded(parts[0]))
        at = near.label
        for i in range(1, self.pieces):
            place = start + (end - start) * i / self.pieces
            before = tuple(
                name
                for name, (link, position) in assembly.points.items()
                if link == self.link
                and name not in assembly.perch
                and (position - place) @ axis < 0.0
            )
            for way, direction in enumerate(across(axis)):
                label = f"bend {i}.{way + 1} of {self.link}"
                is_second = way == 1
                assembly = assembly.split(
                    at,
                    label,
                    hinge_m=place,
                    axis=direction,
                    spring=Spring(k=k, c=k * self.loss),
                    before=Inertial() if is_second else parts[i - 1],
                    after=parts[i] if is_second else Inertial(),
                    points_before=() if is_second else before,
                )
                at = label
        return assembly


def _pieces(whole: Inertial, axis: np.ndarray, length: float, n: int) -> list[Inertial]:
    """Equal masses along the line through the centre, as far apart as the inertia allows."""
    offsets = (np.arange(n) + 0.5) / n - 0.5
    spread = skew(axis)
    steiner = -whole.mass_kg * np.mean(offsets**2) * spread @ spread
    # A quarter of the smallest moment across stays with the pieces themselves.
    room = np.linalg.eigvalsh(whole.inertia_kg_m2)[0] * 0.25 / np.max(np.abs(steiner))
    reach = min(length, float(np.sqrt(room)))
    own = (whole.inertia_kg_m2 - reach**2 * steiner) / n
    return [
        Inertial(
            mass_kg=whole.mass_kg / n,
            center_m=whole.center_m + reach * offset * axis,
            inertia_kg_m2=own,
        )
        for offset in offsets
    ]
