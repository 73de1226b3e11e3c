"""A channel that comes late."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.sensing import CHANNELS, Sensing
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "Delay"]


class Delay(BaseEffect):
    """Channels recorded later than the others by the same time."""

    kind: Literal["delay"]
    channels: Annotated[
        tuple[Literal["hammer", "acc_x", "acc_y", "acc_z"], ...],
        Field(strict=False, min_length=1),
    ]
    delay_s: Positive

    def sense(self, sensing: Sensing) -> Sensing:
        """Add the delay to each of the channels."""
        later = list(sensing.delay_s)
        for channel in set(self.channels):
            later[CHANNELS.index(channel)] += self.delay_s
        return replace(sensing, delay_s=(later[0], later[1], later[2], later[3]))


OF_FILE = {"delay": of_the_test}
