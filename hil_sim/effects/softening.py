"""A joint that is softer for larger motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.file_law import swing_of
from armodal.hil_sim.effects.from_file import FileEffect, Twin, Unlike
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.elements import Softening as SofteningElement
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "OF_FILE", "Softening"]

SOFT_PART, SOFT_AT = 0.4, 0.5  # the latter of the joint's swing after a hit of middle level


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


def _of_file(own: FileEffect) -> Twin:
    """Of p x³/(x² + a²) less: x - a' tanh(x/a') has its slope if a' = a/sqrt(3).

    It is alike in its slope for small swings and in what large ones lose.
    """
    bend = float(np.exp(own.sizes["ln_bend"]))
    part = own.sizes["softer"] * (1.0 + bend**2)
    if not 0.0 < part < 1.0:
        raise Unlike("joint that hardens, or loses more than its spring")
    table = {
        "kind": "softening",
        "joint": own.joint.name,
        "part": part,
        "at_rad": bend * swing_of(own) / float(np.sqrt(3.0)),
    }
    return Twin(tables=[table])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A joint softer for larger motion."""
    joint = places.main_joint(rng)
    part, at = SOFT_PART * magnitude * about(rng), SOFT_AT * places.swing(joint)
    table = {"kind": "softening", "joint": joint, "part": part, "at_rad": at}
    return hidden("softening", joint, table, part=part, at_rad=at)


OF_FILE = {"softening": _of_file}
HIDES = {"softening": Hides(hide=hide, since=2, apart_from=("backlash",))}
