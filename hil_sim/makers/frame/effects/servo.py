"""A servo whose stiffness is finite: gear, rotor and a delayed controller in series."""

from functools import partial

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.structure import Complex

RANGE = (0.01, 4.0)  # compliance of the servo over the gear's
OWN_HZ = (10.0, 90.0)  # of the rotor on its servo
RATIO = (0.25, 1.0)  # damping ratio of that
DELAY_S = 2e-3  # s, of the loop, at most: a period at 500 Hz (`docs/makers.md`)
BRAKE = 300.0  # times as stiff as the servo


def where(drawn: Everyday) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Replace the drive's law by gear and servo in series, exact in frequency.

    A loop that is tuned at all damps its rotor, also where that swings between gear and servo:
    there Im((K + D s) e^(-s T)) > 0, below I w^2 = K + k + D w (Franklin, Powell and
    Emami-Naeini, Feedback Control of Dynamic Systems, section 6.4).
    """
    parts, rng = kit.parts, kit.rng
    drive = parts.drives[place]
    gear, own = drive.stiffness, drive.law
    stiffness = gear / size
    omega = 2.0 * np.pi * float(rng.uniform(*OWN_HZ))
    rotor = stiffness / omega**2
    damping = 2.0 * float(rng.uniform(*RATIO)) * stiffness / omega
    half = damping / (2.0 * rotor)
    fastest = half + float(np.sqrt(half**2 + (stiffness + gear) / rotor))
    undamped = float(np.arctan(damping * fastest / stiffness)) / fastest
    delay = float(rng.uniform(0.0, min(DELAY_S, undamped)))

    def held_by(held: float, s: Complex) -> Complex:
        control = (held + damping * s) * np.exp(-s * delay)
        before, behind = gear + own(s), rotor * s**2 + control
        series: Complex = before * behind / (before + behind) - gear
        return series

    drive.law = partial(held_by, stiffness)
    drive.braked_law = partial(held_by, BRAKE * stiffness)
    return {
        "servo_stiffness_n_m_per_rad": stiffness,
        "servo_damping_n_m_s_per_rad": damping,
        "inertia_kg_m2": rotor,
        "delay_s": delay,
    }
