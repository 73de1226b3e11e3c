"""The arm with hammer and accelerometer, seen as four digital channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt
from scipy import signal

from hil_sim.front_end import FULL_SCALE_COUNTS, FrontEnd
from hil_sim.hand import Blow
from hil_sim.newton_euler import rotation
from hil_sim.plant import BASE, Plant
from hil_sim.small_motion import Mounting, SmallMotion, force_torque, linearise

__all__ = ["SensorSource", "draw_mounting", "force_history", "modal_response"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

MASS_FELT_S = 5.0  # the sensors' high pass forgets a pulse within it
RING_DOWN = 1e-6  # a response is followed until it has decayed to this part


def draw_mounting(plant: Plant, point_id: str, rng: np.random.Generator) -> Mounting:
    """Mount the accelerometer on a point, a little tilted about each of its axes."""
    R = plant.point(point_id).R_link_sensor
    tilt = np.deg2rad(plant.truth.accelerometer.mount_tilt_deg) * rng.standard_normal(3)
    angle = float(np.linalg.norm(tilt))
    if angle > 0.0:
        R = R @ rotation(tilt / angle, angle)
    return Mounting(point_id=point_id, R_link_sensor=R)


def force_history(blow: Blow, begin_s: float, fine_hz: float, n: int) -> Array:
    """Force (n,) in N of a blow that begins at `begin_s`, on a grid of `fine_hz` from 0."""
    t = np.arange(n) / fine_hz
    force = np.zeros(n)
    for pulse in blow.pulses:
        phase = (t - begin_s - pulse.delay_s) / pulse.width_s
        inside = (phase > 0.0) & (phase < 1.0)
        force[inside] += pulse.peak_n * np.sin(np.pi * phase[inside])
    return force


def modal_states(motion: SmallMotion, force: Array, fine_hz: float) -> ComplexArray:
    """States (n_modes, n) of the modes above the real axis under a unit drive, from rest.

    Each first-order mode x' = p x + f is advanced exactly for a force that is linear between
    grid points.
    """
    poles = motion.poles[motion.poles.imag >= 0.0]
    T = 1.0 / fine_hz
    a = poles * T
    ramp, step = (np.exp(a) - 1.0 - a) / a**2, (np.exp(a) - 1.0) / a
    states: ComplexArray = np.stack(
        [
            signal.lfilter([T * r, T * (s - r)], [1.0, -np.exp(z)], force)
            for r, s, z in zip(ramp, step, a, strict=True)
        ]
    )
    return states


def modal_amplitudes(motion: SmallMotion, torque: Array) -> tuple[ComplexArray, Array]:
    """Residues (n_modes, 3) of the modes above the real axis, conjugates counted in; direct part.

    The specific force is the real part of the states times these, plus force times the direct.
    """
    residues, direct = motion.residues(torque)
    upper = motion.poles.imag >= 0.0
    twice = np.where(motion.poles[upper].imag > 0.0, 2.0, 1.0)
    return residues[:, upper].T * twice[:, None], direct


def modal_response(motion: SmallMotion, torque: Array, force: Array, fine_hz: float) -> Array:
    """Specific force (n, 3) at the sensor from a force history, mode by mode, from rest."""
    amplitudes, direct = modal_amplitudes(motion, torque)
    states = modal_states(motion, force, fine_hz)
    response: Array = np.outer(force, direct) + (states.T @ amplitudes).real
    return response


@dataclass(slots=True)
class _Ringing:
    first: int
    counts: Array  # (n, 4)


class SensorSource:
    """The board's four inputs, sample by sample: hammer, acc_x, acc_y, acc_z.

    The same generator, strikes and calls give the same counts however `read` is divided.

    Parameters
    ----------
    mount
        Gives the true mounting of a point: the laboratory keeps it while the sensor stays.
    """

    def __init__(
        self,
        plant: Plant,
        rate_hz: Fraction,
        rng: np.random.Generator,
        mount: Callable[[str], Mounting] | None = None,
    ) -> None:
        self._plant, self._rate_hz = plant, rate_hz
        self._front = FrontEnd(plant.truth, rate_hz)
        white, flicker, moving, mounts = rng.spawn(4)
        self._white, self._flicker, self._vibration = white, flicker, moving
        self._mount = mount or (lambda point: draw_mounting(plant, point, mounts))
        self._joints = np.zeros(len(plant.joints))
        self._mounting: Mounting | None = None
        self._motion: SmallMotion | None = None
        self._moving = False
        self._next = 0
        self._ringing: list[_Ringing] = []
        self._flicker_state = np.zeros((1, 4))
        hammer, sensor = plant.truth.hammer, plant.truth.accelerometer
        per_unit = self._front.counts_per_unit
        self._white_counts = per_unit * [hammer.noise_n, *(sensor.noise_m_s2,) * 3]
        self._flicker_counts = per_unit * [hammer.flicker_n, *(sensor.flicker_m_s2,) * 3]
        self._vibration_counts = per_unit * [0.0, *(sensor.moving_vibration_m_s2,) * 3]

    def set_posture(self, joints_rad: npt.ArrayLike) -> None:
        """Put the arm at rest in a posture."""
        self._joints = np.array(joints_rad, dtype=np.float64)
        self._motion = None

    def mount(self, point_id: str) -> None:
        """Put the accelerometer on a test point."""
        self._mounting = self._mount(point_id)
        self._motion = None

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
        if blow.free_mass_kg is not None:
            self._strike_mass(at_sample, blow, blow.free_mass_kg)
            return
        plant, fine_hz = self._plant, self._front.fine_hz
        if self._motion is None:
            self._motion = linearise(plant, self._joints, self._mounting)
        motion = self._motion
        point = plant.point(blow.point_id)
        position = point.position_m
        if point.body != BASE:
            position = position + motion.at.R[point.body].T @ blow.offset_m
        torque = force_torque(plant, motion.at, point.body, position, blow.direction)
        first = int(np.floor(at_sample))
        slowest = float(np.min(-motion.poles.real))
        last_pulse = max(pulse.delay_s + pulse.width_s for pulse in blow.pulses)
        begin_s = (at_sample - first) / float(self._rate_hz)
        # Fine samples while the hammer touches, and one filter length more; then free decay.
        n_fine = int((begin_s + last_pulse) * fine_hz) + self._front.span + 2
        force = force_history(blow, begin_s, fine_hz, n_fine)
        amplitudes, direct = modal_amplitudes(motion, torque)
        states = modal_states(motion, force, fine_hz)
        felt = np.outer(force, direct) + (states.T @ amplitudes).real
        free = np.zeros((len(amplitudes), 4), dtype=np.complex128)
        free[:, 1:] = states[:, -1:] * amplitudes
        ratio = np.exp(motion.poles[motion.poles.imag >= 0.0] / fine_hz)
        n = int((np.log(1.0 / RING_DOWN) / slowest + last_pulse) * float(self._rate_hz))
        self._ring(first, self._front.sample(np.column_stack([force, felt]), free, ratio, n))

    def _strike_mass(self, at_sample: float, blow: Blow, mass_kg: float) -> None:
        """Hit a freely hung mass through its centre; the sensor's z lies along the hit."""
        fine_hz, rate_hz = self._front.fine_hz, float(self._rate_hz)
        first = int(np.floor(at_sample))
        begin_s = (at_sample - first) / rate_hz
        last_pulse = max(pulse.delay_s + pulse.width_s for pulse in blow.pulses)
        n_fine = int((begin_s + last_pulse) * fine_hz) + self._front.span + 2
        force = force_history(blow, begin_s, fine_hz, n_fine)
        felt = np.outer(force, [0.0, 0.0, 1.0 / mass_kg])
        none = np.zeros((0, 4), dtype=np.complex128)
        n = int((last_pulse + MASS_FELT_S) * rate_hz)
        signal_in = np.column_stack([force, felt])
        self._ring(first, self._front.sample(signal_in, none, none[:, 0], n))

    def _ring(self, first: int, counts: Array) -> None:
        if first < self._next:
            counts, first = counts[self._next - first :], self._next
        self._ringing.append(_Ringing(first=first, counts=counts))

    def read(self, n: int) -> npt.NDArray[np.int32]:
        """Return the next (n, 4) counts."""
        first, last = self._next, self._next + n
        counts = self._white.standard_normal((n, 4)) * self._white_counts
        if self._moving:
            counts += self._vibration.standard_normal((n, 4)) * self._vibration_counts
        counts += self._flicker_of(n) * self._flicker_counts
        for ringing in self._ringing:
            begin, end = max(first, ringing.first), min(last, ringing.first + len(ringing.counts))
            if begin < end:
                part = slice(begin - ringing.first, end - ringing.first)
                counts[begin - first : end - first] += ringing.counts[part]
        self._ringing = [r for r in self._ringing if r.first + len(r.counts) > last]
        self._next = last
        return np.clip(np.rint(counts), -FULL_SCALE_COUNTS - 1, FULL_SCALE_COUNTS).astype(np.int32)

    def _flicker_of(self, n: int) -> Array:
        """Slow noise (n, 4) of unit deviation: white noise through a low pass at 1 Hz."""
        if n == 0:  # lfilter leaves the state undefined
            return np.zeros((0, 4))
        keep = float(np.exp(-2.0 * np.pi / float(self._rate_hz)))
        drive = np.sqrt(1.0 - keep**2) * self._flicker.standard_normal((n, 4))
        slow, state = signal.lfilter([1.0], [1.0, -keep], drive, axis=0, zi=self._flicker_state)
        self._flicker_state = state
        result: Array = slow
        return result
