"""Backlash in a joint's transmission."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.file_law import swing_of
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.elements import Gap
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Backlash"]

PLAY = 0.22  # half of it / swing after a hit of middle level


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Play where weight does not close it in most postures: in the joint with the least load."""
    loads = {name: float(np.median(np.abs(places.loads(name)))) for name in places.elastic[:4]}
    joint = min(loads, key=lambda name: loads[name])
    half = PLAY * places.swing(joint) * magnitude * about(rng)
    table = {"kind": "backlash", "joint": joint, "half_rad": half}
    return hidden("backlash", joint, table, half_rad=half)


OF_FILE = {"backlash": _of_file}
COMPARED = {"backlash": told("part")}
HIDES = {"backlash": Hides(hide=hide, since=2)}
