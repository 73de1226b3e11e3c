"""The plant with its sensors and its hand, as the laboratory's process wants them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.hand import Blow, blow, hand_at
from armodal.hil_sim.lab_process import ArmInCell
from armodal.hil_sim.plant import Plant
from armodal.hil_sim.small_motion import Mounting
from armodal.hil_sim.source import SensorSource, draw_mounting

__all__ = ["arm_in_cell"]


class _Hands:
    """What people do to the arm: they mount the sensor, crookedly, and hit, not quite there."""

    def __init__(self, plant: Plant, seed: int) -> None:
        self._plant = plant
        streams = np.random.SeedSequence([seed, 1]).spawn(3)
        self._mounts, self._swings, self._noise = (np.random.default_rng(s) for s in streams)
        self._mounting: Mounting | None = None

    def make_source(self, rate_hz: Fraction) -> SensorSource:
        return SensorSource(self._plant, rate_hz, self._noise, mount=self._mount)

    def _mount(self, point_id: str) -> Mounting:
        # A sensor that stays where it is keeps its tilt, also when the board starts again.
        if self._mounting is None or self._mounting.point_id != point_id:
            self._mounting = draw_mounting(self._plant, point_id, self._mounts)
        return self._mounting

    def swing(
        self, point_id: str, direction: npt.NDArray[np.float64], peak_n: float | None
    ) -> tuple[Blow, dict[str, object]]:
        hand = hand_at(self._plant.truth.hand, peak_n)
        return self._told(blow(hand, self._swings, point_id, direction))

    def swing_at_mass(self, mass_kg: float) -> tuple[Blow, dict[str, object]]:
        any_point = next(iter(self._plant.points))
        swung = blow(self._plant.truth.hand, self._swings, any_point, [0.0, 0.0, 1.0])
        return self._told(replace(swung, free_mass_kg=mass_kg))

    def _told(self, landed: Blow) -> tuple[Blow, dict[str, object]]:
        facts: dict[str, object] = {
            "kind": landed.kind,
            "direction": landed.direction.tolist(),
            "offset_m": landed.offset_m.tolist(),
            "pulses": [
                {"delay_s": p.delay_s, "peak_n": p.peak_n, "width_s": p.width_s}
                for p in landed.pulses
            ],
        }
        return landed, facts

    def mounted(self) -> Mapping[str, object]:
        if self._mounting is None:
            return {}
        return {"R_link_sensor": self._mounting.R_link_sensor.tolist()}


def arm_in_cell(plant: Plant, *, seed: int) -> ArmInCell[Blow]:
    """Put the arm with its sensors into the cell, and a person beside it."""
    hands = _Hands(plant, seed)
    return ArmInCell(
        plant=plant,
        make_source=hands.make_source,
        swing=hands.swing,
        swing_at_mass=hands.swing_at_mass,
        mounted=hands.mounted,
    )
