"""A joint that is softer for larger motion."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.elements import Softening as SofteningElement
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

__all__ = ["Softening"]


class Softening(BaseEffect):
    """The part `part` of the joint's stiffness saturates about a stretch of `at_rad`."""

    kind: Literal["softening"]
    joint: str
    part: Annotated[float, Field(gt=0.0, lt=1.0)]
    at_rad: Positive

    def act(self, terms: LinearTerms) -> None:
        """Take torque from large stretches."""
        terms.elements.append(
            SofteningElement(
                row=terms.stretch_of(self.joint),
                soft=self.part * terms.springs[self.joint].k,
                at=self.at_rad,
            )
        )
