"""A channel that comes late."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.sensing import CHANNELS, Sensing
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Delay"]

DELAY_S = 6e-4


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Hammer or all of the accelerometer, late."""
    del places
    late_s = float(DELAY_S * magnitude * about(rng))
    of_hammer = rng.random() < 0.5
    table = {
        "kind": "delay",
        "channels": ("hammer",) if of_hammer else ("acc_x", "acc_y", "acc_z"),
        "delay_s": late_s,
    }
    return hidden("delay", "hammer" if of_hammer else "accelerometer", table, delay_s=late_s)


def _size_s(true: TrueEffect) -> float:
    """Of the accelerometer behind the hammer."""
    return float(true.parameters["delay_s"] * (-1.0 if true.place == "hammer" else 1.0))


def _others_s(true: TrueEffect) -> float:
    if "plant" not in true.case:
        return 0.0
    same = [e for e in true.case["plant"]["effects"] if e["kind"] == "delay"]
    total = sum(e["delay_s"] * (-1.0 if "hammer" in e["channels"] else 1.0) for e in same)
    return float(total - _size_s(true))


OF_FILE = {"delay": of_the_test}
COMPARED = {"delay": Compared(size=_size_s, beside=_others_s)}
HIDES = {"delay": Hides(hide=hide, since=1)}
