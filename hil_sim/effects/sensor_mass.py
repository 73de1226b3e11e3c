"""An accelerometer heavier than its file says."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Positive

__all__ = ["OF_FILE", "SensorMass"]


class SensorMass(BaseEffect):
    """Base, magnet or cable ride with the accelerometer from point to point."""

    kind: Literal["sensor_mass"]
    extra_kg: Positive

    def sense(self, sensing: Sensing) -> Sensing:
        """Add the mass."""
        return replace(sensing, extra_sensor_kg=sensing.extra_sensor_kg + self.extra_kg)


OF_FILE = {"sensor_mass": of_the_test}
