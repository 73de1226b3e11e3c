"""Hammer, tip, accelerometer and trigger for an arm of this size.

A hammer of head mass m that meets the arm at 1 m/s and leaves it as fast as it came gives the
impulse 2 m v less what the arm takes; 1.3 m v is what roving hammers give on structures that are
heavy against them. Its pulse is near a half sine of length tau, whose spectrum is flat to 1/(2 tau)
within 3 dB (D. Ewins, Modal Testing, 2nd ed. 2000, section 3.4): the tip is chosen for
tau = 1/(2 f_top), and the peak is p pi/(2 tau).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.equations import PlannedArm
from armodal.analyzer.planning.excitation import posture_modes
from armodal.analyzer.planning.expected import Instruments
from armodal.protocols.errors import PlanError
from armodal.protocols.sensors_file import Accelerometer, Equipment, Hammer

__all__ = ["Chosen", "chosen_equipment"]

Array = npt.NDArray[np.float64]

SPEED_M_S = 1.0
REBOUND = 1.3
HEAD_OF_MASS = 0.02  # of what the hammer meets, where there is a hammer that light or heavy
HEADROOM = 0.5  # of the ranges
TRIGGER = 0.1  # of the expected peak
HIGHEST_HZ = 200.0
N_POSTURES = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """What a plan is measured with."""

    hammer: Hammer
    accelerometer: Accelerometer
    peak_n: float
    impulse_n_s: float
    pulse_s: float  # length of the pulse that the tip should give
    trigger_n: float
    mass_met_kg: float  # by a hit, in the middle of the arm's points and postures
    top_hz: float
    source: str

    @property
    def told_peak_n(self) -> str:
        """The peak to two digits."""
        return f"{float(f'{self.peak_n:.2g}'):g}"

    @property
    def instruments(self) -> Instruments:
        """The same for the standard deviations to expect."""
        return Instruments(
            impulse_n_s=self.impulse_n_s,
            acceleration_noise=self.accelerometer.noise,
            force_peak_n=self.peak_n,
            acceleration_range=self.accelerometer.range_m_s2,
        )


def chosen_equipment(planned: PlannedArm, postures_rad: Array, equipment: Equipment) -> Chosen:
    """Choose from a laboratory's equipment for postures (n, n_joints) as the plan may take them.

    Raises
    ------
    PlanError
        If no accelerometer is light enough, or none has the range.
    """
    masses, tops = [], []
    moving = [i for i, link in enumerate(planned.superset.point_link) if link >= 0]
    for q in postures_rad[:N_POSTURES]:
        at = planned.at(q)
        modes = posture_modes(at)
        tops.append(float(modes.f_hz.max()))
        along = np.einsum("pi,pij->pj", at.point_rotation[moving][:, :, 2], at.point_linear[moving])
        masses += list(modes.effective_mass_kg(along @ modes.shape))
    # Points near the base move little; those that are hit are among the lighter half.
    met = float(np.quantile(masses, 0.25))
    top = min(float(np.median(tops)), HIGHEST_HZ)
    fitting = [one for one in equipment.hammers if one.head_kg >= HEAD_OF_MASS * met]
    hammer = (
        min(fitting, key=lambda one: one.head_kg)
        if fitting
        else max(equipment.hammers, key=lambda one: one.head_kg)
    )
    pulse = 0.5 / top
    impulse = REBOUND * min(hammer.head_kg, met) * SPEED_M_S
    peak = min(0.5 * np.pi * impulse / pulse, HEADROOM * hammer.range_n)
    impulse = 2.0 / np.pi * peak * pulse
    light = [one for one in equipment.accelerometers if one.mass_kg <= 0.05 * met]
    able = [one for one in light if HEADROOM * one.range_m_s2 >= peak / met]
    if not able:
        raise PlanError(
            f"{equipment.source}: wanted an accelerometer of at most {50 * met:.3g} g with a range "
            f"of {peak / met / HEADROOM:.3g} m/s², since a hit of {peak:.3g} N meets {met:.3g} kg; "
            "found none"
        )
    return Chosen(
        hammer=hammer,
        accelerometer=min(able, key=lambda one: one.noise),
        peak_n=float(peak),
        impulse_n_s=float(impulse),
        pulse_s=pulse,
        trigger_n=_one_two_five(TRIGGER * float(peak)),
        mass_met_kg=met,
        top_hz=top,
        source=equipment.source,
    )


def _one_two_five(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * 1.0001))
