"""What goes wrong between the arm and the record: axes, gains, delays, encoders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

__all__ = ["CHANNELS", "Sensing"]

Array = npt.NDArray[np.float64]

CHANNELS = ("hammer", "acc_x", "acc_y", "acc_z")


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensing:
    """The measurement's own faults, none by default.

    `everywhere` acts on the three accelerometer channels at every point, `at_point` at one, after
    it. Delays are of (hammer, acc_x, acc_y, acc_z). A joint truly stands at what its encoder
    reads minus `encoder_rad`. Where a point is asked for that `stands_at` names, the sensor stands
    at the other; points in `moved` are off by a vector of their link's frame. Every hit's direction
    is turned by `hit_turn` (base axes). The accelerometer is heavier than its file says by
    `extra_sensor_kg`. Records are multiplied by an exponential that falls to `window_end` over the
    block; only sessions made block by block know it.
    """

    hammer_gain: float = 1.0
    everywhere: Array = field(default_factory=lambda: np.eye(3))
    at_point: Mapping[str, Array] = field(default_factory=dict)
    delay_s: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    encoder_rad: Mapping[str, float] = field(default_factory=dict)
    stands_at: Mapping[str, str] = field(default_factory=dict)
    moved: Mapping[str, Array] = field(default_factory=dict)
    hit_turn: Array = field(default_factory=lambda: np.eye(3))
    extra_sensor_kg: float = 0.0
    window_end: float = 1.0

    def gains(self, point_id: str | None) -> Array:
        """(4, 4) from what would be recorded to what is, sensor at a point."""
        result = np.eye(4)
        result[0, 0] = self.hammer_gain
        local = np.eye(3) if point_id is None else self.at_point.get(point_id, np.eye(3))
        result[1:, 1:] = local @ self.everywhere
        return result
