"""A sensor that does not stand where the record says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain, unit
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "ExchangedPoints", "MovedPoint"]

MOVED_M = 0.12


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Two points of a link exchanged when clear; else one point off its place."""
    links = [name for name in places.structural() if name != list(places.links)[-1]]
    link = str(rng.choice(links))
    points = [point["id"] for point in places.points[link]]
    if magnitude >= 1.0:
        pair = sorted(str(name) for name in rng.choice(points, 2, replace=False))
        table = {"kind": "exchanged_points", "points": tuple(pair)}
        return hidden("wrong_point", pair, table, exchanged=pair)
    point = str(rng.choice(points))
    by = MOVED_M * magnitude * about(rng) * unit(rng)
    moved = {"kind": "moved_point", "point": point, "by_m": plain(by)}
    return hidden("wrong_point", [point], moved, by_m=places.in_file(link, by))


def _first_shift(true: TrueEffect) -> float:
    return float(true.parameters["by_m"][0])


OF_FILE = {"wrong_point": of_the_test}
COMPARED = {"wrong_point": Compared(size=_first_shift)}
HIDES = {"wrong_point": Hides(hide=hide, since=2)}
