"""Wrong gains: of one accelerometer channel, of the hammer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect, with_point_matrix
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, all_or_one_point, hidden
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "ChannelGain", "HammerGain"]

# Logarithms of the factors by which a sensitivity is off.
CHANNEL_GAIN = 0.25
HAMMER_GAIN = 0.45


class ChannelGain(BaseEffect):
    """An accelerometer channel recorded `factor` times too large, at some points or at all."""

    kind: Literal["channel_gain"]
    axis: Literal["x", "y", "z"]
    factor: Positive
    points: Annotated[tuple[str, ...], Field(strict=False)] = ()

    def sense(self, sensing: Sensing) -> Sensing:
        """Scale the channel."""
        matrix = np.eye(3)
        i = "xyz".index(self.axis)
        matrix[i, i] = self.factor
        return with_point_matrix(sensing, self.points, matrix)


class HammerGain(BaseEffect):
    """A force recorded `factor` times too large."""

    kind: Literal["hammer_gain"]
    factor: Positive

    def sense(self, sensing: Sensing) -> Sensing:
        """Scale the force."""
        return replace(sensing, hammer_gain=sensing.hammer_gain * self.factor)


def _hide_channel_gain(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """One channel, at all points or at one."""
    axis = str(rng.choice(list("xyz")))
    points = all_or_one_point(places, rng, float(rng.random() * 2.0))
    factor = _factor(CHANNEL_GAIN, rng, magnitude)
    table = {"kind": "channel_gain", "axis": axis, "factor": factor, "points": points}
    return hidden("channel_gain", list(points) or "all", table, axis=axis, factor=factor)


def _hide_hammer_gain(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """The hammer's sensitivity."""
    del places
    factor = _factor(HAMMER_GAIN, rng, magnitude)
    return hidden("hammer_gain", "hammer", {"kind": "hammer_gain", "factor": factor}, factor=factor)


def _factor(step: float, rng: np.random.Generator, magnitude: float) -> float:
    """Too large or too small."""
    return float(np.exp(rng.choice([-1.0, 1.0]) * step * magnitude * about(rng)))


def _logarithm(true: TrueEffect) -> float:
    return float(np.log(true.parameters["factor"]))


def _ordinary_hammer(true: TrueEffect) -> float:
    if "plant" not in true.case:
        return 0.0
    return float(np.log1p(true.case["plant"]["hammer"]["gain_error"]))


def _ordinary_channel(true: TrueEffect) -> float:
    if "plant" not in true.case or true.place != "all":
        return 0.0
    axis = "xyz".index(true.parameters["axis"])
    return float(np.log(true.case["plant"]["accelerometer"]["response"][axis][axis]))


def _axis(true: TrueEffect) -> list[str]:
    return [f"axis {true.parameters['axis']}"]


def _at_point(true: TrueEffect) -> Mapping[str, object] | None:
    if true.place == "all" or len(true.place) > 1:
        return None
    return {"axis": true.parameters["axis"], "sensor_point": true.place[0]}


OF_FILE = {"channel_gain": of_the_test, "hammer_gain": of_the_test}
COMPARED = {
    "channel_gain": Compared(
        size=_logarithm, beside=_ordinary_channel, places=_axis, described=_at_point
    ),
    "hammer_gain": Compared(size=_logarithm, beside=_ordinary_hammer),
}
HIDES = {
    "channel_gain": Hides(hide=_hide_channel_gain, since=1, placed=True),
    "hammer_gain": Hides(hide=_hide_hammer_gain, since=1),
}
