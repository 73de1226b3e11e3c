"""An exponential window that the front end applied and nobody wrote down."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.sensing import Sensing

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "OF_FILE", "ExponentialWindow"]

WINDOW = 3.0  # minus the logarithm of its end


class ExponentialWindow(BaseEffect):
    """All channels multiplied by an exponential that falls to `end` over the record."""

    kind: Literal["exponential_window"]
    end: Annotated[float, Field(gt=0.0, lt=1.0)]

    def sense(self, sensing: Sensing) -> Sensing:
        """Let it fall further."""
        return replace(sensing, window_end=sensing.window_end * self.end)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A front end's window that nobody corrects."""
    del places
    end = float(np.exp(-WINDOW * magnitude * about(rng)))
    table = {"kind": "exponential_window", "end": end}
    return hidden("exponential_window", "all", table, end=end)


OF_FILE = {"exponential_window": of_the_test}
HIDES = {"exponential_window": Hides(hide=hide, since=2)}
