"""The arm with hammer and accelerometer, seen as four digital channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.free_mass import felt_on_mass
from armodal.hil_sim.front_end import FULL_SCALE_COUNTS, FrontEnd
from armodal.hil_sim.hand import Blow
from armodal.hil_sim.newton_euler import rotation
from armodal.hil_sim.noise import ChannelNoise, white_noise
from armodal.hil_sim.plant import BASE, Plant
from armodal.hil_sim.ringing import Strike, ring
from armodal.hil_sim.sensing import CHANNELS
from armodal.hil_sim.small_motion import Mounting, SmallMotion, force_torque, linearise
from armodal.hil_sim.streams import Streams

__all__ = ["SensorSource", "draw_mounting", "strike_of"]

Array = npt.NDArray[np.float64]


def draw_mounting(plant: Plant, point_id: str, rng: np.random.Generator) -> Mounting:
    """Mount the accelerometer on a point, a little tilted about each of its axes."""
    R = plant.point(point_id).R_link_sensor
    tilt = np.deg2rad(plant.truth.accelerometer.mount_tilt_deg) * rng.standard_normal(3)
    angle = float(np.linalg.norm(tilt))
    if angle > 0.0:
        R = R @ rotation(tilt / angle, angle)
    return Mounting(point_id=point_id, R_link_sensor=R)


def strike_of(plant: Plant, motion: SmallMotion, blow: Blow, begin_s: float) -> Strike:
    """Where a blow truly lands and what it does to the coordinates.

    Raises
    ------
    PlantError
        If the point is unknown.
    """
    point = plant.point(blow.point_id)
    position = point.position_m
    if point.body != BASE:
        position = position + motion.at.R[point.body].T @ blow.offset_m
    direction = plant.sensing.hit_turn @ blow.direction
    torque = force_torque(plant, motion.at, point.body, position, direction)
    return Strike(motion=motion, torque=torque, blow=blow, begin_s=begin_s)


@dataclass(slots=True)
class _Ringing:
    first: int
    counts: Array  # (n, 4)


class SensorSource:
    """The board's four inputs, sample by sample: hammer, acc_x, acc_y, acc_z.

    The same streams, strikes and calls give the same counts however `read` is divided.

    Parameters
    ----------
    mount
        Gives the true mounting of a point: the laboratory keeps it while the sensor stays.
    """

    def __init__(
        self,
        plant: Plant,
        rate_hz: Fraction,
        streams: Streams,
        mount: Callable[[str], Mounting] | None = None,
    ) -> None:
        self._plant, self._rate_hz = plant, rate_hz
        self._front = FrontEnd(plant.truth, rate_hz)
        self._noise = ChannelNoise(plant.truth, self._front, streams)
        self._vibration = [streams("vibration", channel) for channel in CHANNELS]
        mounts = streams("mounts")
        self._mount = mount or (lambda point: draw_mounting(self._plant, point, mounts))
        self._joints = np.zeros(len(plant.joints))
        self._label: str | None = None
        self._mounting: Mounting | None = None
        self._motion: SmallMotion | None = None
        self._moving = False
        self._next = 0
        self._ringing: list[_Ringing] = []
        moving = plant.truth.accelerometer.moving_vibration_m_s2
        self._vibration_counts = self._front.counts_per_unit * [0.0, *(moving,) * 3]

    @property
    def next_sample(self) -> int:
        """Index of the sample that the next read begins with."""
        return self._next

    def set_posture(self, joints_rad: npt.ArrayLike) -> None:
        """Put the arm at rest in a posture."""
        self._joints = np.array(joints_rad, dtype=np.float64)
        self._motion = None

    def mount(self, point_id: str) -> None:
        """Put the accelerometer on a test point."""
        self._label = point_id
        self._mounting = self._mount(self._plant.sensing.stands_at.get(point_id, point_id))
        self._motion = None

    def take_points(self, plant: Plant) -> None:
        """Go on with the same arm whose test points are marked anew."""
        self._plant, self._motion = plant, None
        if self._label is not None:
            self.mount(self._label)

    def set_moving(self, moving: bool) -> None:
        """Tell whether the drives move the arm."""
        self._moving = moving

    def strike(self, at_sample: float, blow: Blow) -> None:
        """Add a hit that begins at a sample index, fractions allowed.

        Raises
        ------
        PlantError
            If the point is unknown.
        """
        plant, rate_hz = self._plant, float(self._rate_hz)
        first = int(np.floor(at_sample))
        begin_s = (at_sample - first) / rate_hz
        if blow.free_mass_kg is not None:
            counts = felt_on_mass(self._front, blow, blow.free_mass_kg, begin_s, rate_hz)
        else:
            if self._motion is None:
                self._motion = linearise(plant, self._joints, self._mounting)
            strike = strike_of(plant, self._motion, blow, begin_s)
            (counts,) = ring(self._front, [strike], plant.sensing.delay_s)
        counts = counts @ plant.sensing.gains(self._label).T
        if first < self._next:
            counts, first = counts[self._next - first :], self._next
        self._ringing.append(_Ringing(first=first, counts=counts))

    def rest(self) -> None:
        """Wait until every hit has rung out; the noise goes on as if no time had passed."""
        self._next = max([self._next, *(r.first + len(r.counts) for r in self._ringing)])
        self._ringing = []

    def read(self, n: int) -> npt.NDArray[np.int32]:
        """Return the next (n, 4) counts."""
        first, last = self._next, self._next + n
        counts = self._noise.read(n)
        if self._moving:
            counts += white_noise(self._vibration, n) * self._vibration_counts
        for ringing in self._ringing:
            begin, end = max(first, ringing.first), min(last, ringing.first + len(ringing.counts))
            if begin < end:
                part = slice(begin - ringing.first, end - ringing.first)
                counts[begin - first : end - first] += ringing.counts[part]
        self._ringing = [r for r in self._ringing if r.first + len(r.counts) > last]
        self._next = last
        return np.clip(np.rint(counts), -FULL_SCALE_COUNTS - 1, FULL_SCALE_COUNTS).astype(np.int32)
