"""An exponential window that the front end applied and nobody wrote down."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.sensing import Sensing

__all__ = ["OF_FILE", "ExponentialWindow"]


class ExponentialWindow(BaseEffect):
    """All channels multiplied by an exponential that falls to `end` over the record."""

    kind: Literal["exponential_window"]
    end: Annotated[float, Field(gt=0.0, lt=1.0)]

    def sense(self, sensing: Sensing) -> Sensing:
        """Let it fall further."""
        return replace(sensing, window_end=sensing.window_end * self.end)


OF_FILE = {"exponential_window": of_the_test}
