"""The plant with its sensors and its hand, as the laboratory's process wants them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import numpy.typing as npt
import scipy.signal  # noqa: F401 - loaded before the clock runs, not with the first sample

from armodal.hil_sim.hand import Blow, blow, hand_at
from armodal.hil_sim.lab_process import ArmInCell
from armodal.hil_sim.marked_point import with_point
from armodal.hil_sim.operator import Marking
from armodal.hil_sim.plant import Plant
from armodal.hil_sim.plant_file import HandTruth
from armodal.hil_sim.small_motion import Mounting
from armodal.hil_sim.source import SensorSource, draw_mounting
from armodal.hil_sim.streams import Streams, stream
from armodal.protocols.arm.records import CanMapping

__all__ = ["arm_in_cell"]


class _Hands:
    """What people do to the arm: they mount the sensor, crookedly, and hit, not quite there."""

    def __init__(self, plant: Plant, streams: Streams) -> None:
        self._plant = plant
        self._streams = streams
        self._mounts = streams("mounts")
        self._swings, self._starts = itertools.count(), itertools.count()
        self._mounting: Mounting | None = None
        self._source: SensorSource | None = None

    def make_source(self, rate_hz: Fraction) -> SensorSource:
        streams = partial(self._streams, "source", next(self._starts))
        self._source = SensorSource(self._plant, rate_hz, streams, mount=self._mount)
        return self._source

    def mark(self, point_id: str, marking: Marking) -> None:
        """Mark a point anew; a sensor that sits on it is taken along."""
        self._plant = with_point(self._plant, point_id, marking)
        if self._mounting is not None and self._mounting.point_id == point_id:
            self._mounting = None
        if self._source is not None:
            self._source.take_points(self._plant)

    def _mount(self, point_id: str) -> Mounting:
        # A sensor that stays where it is keeps its tilt, also when the board starts again.
        if self._mounting is None or self._mounting.point_id != point_id:
            self._mounting = draw_mounting(self._plant, point_id, self._mounts)
        return self._mounting

    def swing(
        self, point_id: str, direction: npt.NDArray[np.float64], peak_n: float | None
    ) -> tuple[Blow, dict[str, object]]:
        return self._told(self._blow(hand_at(self._plant.truth.hand, peak_n), point_id, direction))

    def swing_at_mass(self, mass_kg: float) -> tuple[Blow, dict[str, object]]:
        any_point = next(iter(self._plant.points))
        swung = self._blow(self._plant.truth.hand, any_point, [0.0, 0.0, 1.0])
        return self._told(replace(swung, free_mass_kg=mass_kg))

    def _blow(self, hand: HandTruth, point_id: str, direction: npt.ArrayLike) -> Blow:
        return blow(hand, self._streams("swing", next(self._swings)), point_id, direction)

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


def arm_in_cell(plant: Plant, *, seed: int, can: CanMapping | None = None) -> ArmInCell[Blow]:
    """Put the arm with its sensors into the cell, its controller, and a person beside it."""
    hands = _Hands(plant, partial(stream, seed, "arm"))
    return ArmInCell(
        plant=plant,
        make_source=hands.make_source,
        swing=hands.swing,
        swing_at_mass=hands.swing_at_mass,
        mark=hands.mark,
        mounted=hands.mounted,
        can=can,
    )
