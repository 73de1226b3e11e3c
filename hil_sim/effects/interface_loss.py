"""Hinges that lose by a factor that hardly depends on frequency: bolts, seats, castings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.hysteretic import (
    BAND_HZ,
    ELEMENTS,
    MOST_LOSS,
    beside_a_spring,
    loss_told,
)
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

__all__ = ["InterfaceLoss", "loss_of_file"]


class InterfaceLoss(BaseEffect):
    """Maxwell elements beside the springs of hinges that other effects cut.

    `stiffness` has each hinge by its label, as it is at the frequency arm files mean.
    """

    kind: Literal["interface_loss"]
    stiffness: dict[str, Positive]
    loss_factor: Annotated[float, Field(gt=0.0, le=MOST_LOSS)]

    def act(self, terms: LinearTerms) -> None:
        """Put them there."""
        for label, k in self.stiffness.items():
            row, lossy = terms.stretch.get(label, terms.row(label)), self.loss_factor * k
            beside_a_spring(terms, row, lossy, (BAND_HZ, ELEMENTS), STIFFNESS_AT_HZ)


def loss_of_file(factor: float, stiffness: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return the table of hinges with a file's loss factor; none where it tells none."""
    if factor <= 0.0 or not stiffness:
        return []
    return [
        {
            "kind": "interface_loss",
            "stiffness": dict(stiffness),
            "loss_factor": loss_told(factor),
        }
    ]
