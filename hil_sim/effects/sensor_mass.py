"""An accelerometer heavier than its file says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "SensorMass"]

SENSOR_KG = 0.12


class SensorMass(BaseEffect):
    """Base, magnet or cable ride with the accelerometer from point to point."""

    kind: Literal["sensor_mass"]
    extra_kg: Positive

    def sense(self, sensing: Sensing) -> Sensing:
        """Add the mass."""
        return replace(sensing, extra_sensor_kg=sensing.extra_sensor_kg + self.extra_kg)


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Base and cable of the accelerometer, beside the mass that its file gives."""
    del places
    extra = float(SENSOR_KG * magnitude * about(rng))
    table = {"kind": "sensor_mass", "extra_kg": extra}
    return hidden("sensor_mass", "accelerometer", table, extra_kg=extra)


OF_FILE = {"sensor_mass": of_the_test}
COMPARED = {"sensor_mass": told("extra_kg")}
HIDES = {"sensor_mass": Hides(hide=hide, since=2)}
