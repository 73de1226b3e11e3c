"""Hinges that lose by a factor that hardly depends on frequency: bolts, seats, castings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.hysteretic import FILE_HZ, beside_a_spring
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

__all__ = ["InterfaceLoss", "loss_of_file"]

_MOST_LOSS = 0.3  # more is no loss of a structure
_BAND_HZ = 5.0, 200.0
_ELEMENTS = 5


class InterfaceLoss(BaseEffect):
    """Maxwell elements beside the springs of hinges that other effects cut.

    `stiffness` has each hinge by its label, as it is at the frequency arm files mean.
    """

    kind: Literal["interface_loss"]
    stiffness: dict[str, Positive]
    loss_factor: Annotated[float, Field(gt=0.0, le=_MOST_LOSS)]

    def act(self, terms: LinearTerms) -> None:
        """Put them there."""
        for label, k in self.stiffness.items():
            row, lossy = terms.row(label), self.loss_factor * k
            beside_a_spring(terms, row, lossy, (_BAND_HZ, _ELEMENTS), FILE_HZ)


def loss_of_file(factor: float, stiffness: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return the table of hinges with a file's loss factor; none where it tells none."""
    if factor <= 0.0 or not stiffness:
        return []
    return [
        {
            "kind": "interface_loss",
            "stiffness": dict(stiffness),
            "loss_factor": min(factor, _MOST_LOSS),
        }
    ]
