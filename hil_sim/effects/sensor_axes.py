"""Axes of the accelerometer flipped or swapped."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from armodal.hil_sim.effects.effect import BaseEffect, with_point_matrix
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, all_or_one_point, hidden
from armodal.hil_sim.sensing import Sensing

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "OF_FILE", "FlippedAxis", "SwappedAxes"]

Axis = Literal["x", "y", "z"]
Points = Annotated[tuple[str, ...], Field(strict=False)]


class FlippedAxis(BaseEffect):
    """An axis recorded with the other sign, at the points named or at all."""

    kind: Literal["flipped_axis"]
    axis: Axis
    points: Points = ()

    def sense(self, sensing: Sensing) -> Sensing:
        """Turn the sign."""
        matrix = np.eye(3)
        i = "xyz".index(self.axis)
        matrix[i, i] = -1.0
        return with_point_matrix(sensing, self.points, matrix)


class SwappedAxes(BaseEffect):
    """Two axes recorded in each other's place, at the points named or at all."""

    kind: Literal["swapped_axes"]
    axes: Annotated[tuple[Axis, Axis], Field(strict=False)]
    points: Points = ()

    @model_validator(mode="after")
    def _are_two(self) -> Self:
        if self.axes[0] == self.axes[1]:
            raise ValueError("axes must be two different ones")
        return self

    def sense(self, sensing: Sensing) -> Sensing:
        """Exchange the rows."""
        order = [0, 1, 2]
        i, j = ("xyz".index(axis) for axis in self.axes)
        order[i], order[j] = j, i
        return with_point_matrix(sensing, self.points, np.eye(3)[order])


def _hide_flipped_axis(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """One axis: at all points when clear, at one when not."""
    axis, points = str(rng.choice(list("xyz"))), all_or_one_point(places, rng, magnitude)
    table = {"kind": "flipped_axis", "axis": axis, "points": points}
    return hidden("flipped_axis", list(points) or "all", table, axis=axis)


def _hide_swapped_axes(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Two axes: at all points when clear, at one when not."""
    left_out = int(rng.integers(3))
    axes = tuple("xyz".replace("xyz"[left_out], ""))
    points = all_or_one_point(places, rng, magnitude)
    table = {"kind": "swapped_axes", "axes": axes, "points": points}
    return hidden("swapped_axes", list(points) or "all", table, axes=list(axes))


OF_FILE = {"flipped_axis": of_the_test, "swapped_axes": of_the_test}
HIDES = {
    "flipped_axis": Hides(
        hide=_hide_flipped_axis, since=1, placed=True, apart_from=("swapped_axes", "channel_gain")
    ),
    "swapped_axes": Hides(hide=_hide_swapped_axes, since=1, placed=True),
}
