"""Wrong gains: of one accelerometer channel, of the hammer."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect, with_point_matrix
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "ChannelGain", "HammerGain"]


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


OF_FILE = {"channel_gain": of_the_test, "hammer_gain": of_the_test}
