"""A sensor that does not stand where the record says."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Vector

__all__ = ["OF_FILE", "ExchangedPoints", "MovedPoint"]


class ExchangedPoints(BaseEffect):
    """Two points measured under each other's name."""

    kind: Literal["exchanged_points"]
    points: Annotated[tuple[str, str], Field(strict=False)]

    def sense(self, sensing: Sensing) -> Sensing:
        """Note where the sensor truly stands."""
        first, second = self.points
        return replace(sensing, stands_at={**sensing.stands_at, first: second, second: first})


class MovedPoint(BaseEffect):
    """A point that is not where the arm file has it, by a vector of its link's frame."""

    kind: Literal["moved_point"]
    point: str
    by_m: Vector

    def sense(self, sensing: Sensing) -> Sensing:
        """Note the shift."""
        return replace(sensing, moved={**sensing.moved, self.point: np.array(self.by_m)})


OF_FILE = {"wrong_point": of_the_test}
