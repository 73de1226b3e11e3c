"""Backlash in a joint's transmission."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.file_law import swing_of
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.elements import Gap
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "Backlash"]


class Backlash(BaseEffect):
    """The part `part` of the joint's spring does nothing over `2 half_rad`.

    The arm's weight lays the teeth on one side; only what swings back through the torque at rest
    crosses the play.
    """

    kind: Literal["backlash"]
    joint: str
    half_rad: Positive
    part: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0

    def act(self, terms: LinearTerms) -> None:
        """Open the play about the load of the posture."""
        terms.elements.append(
            Gap(
                row=terms.stretch_of(self.joint),
                k=self.part * terms.springs[self.joint].k,
                half=self.half_rad,
                load=-self.part * terms.load[self.joint],
            )
        )


def _of_file(own: FileEffect) -> Twin:
    """A part of the spring holds nothing over a play; the weight lays it to one side."""
    table = {
        "kind": "backlash",
        "joint": own.joint.name,
        "half_rad": swing_of(own) * float(np.exp(own.sizes["ln_half_play"])),
        "part": min(own.sizes["play"], 1.0),
    }
    return Twin(tables=[table])


OF_FILE = {"backlash": _of_file}
