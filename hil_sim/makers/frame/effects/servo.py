"""A servo whose stiffness is finite: gear, rotor and a delayed controller in series."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.structure import Complex

RANGE = (0.01, 4.0)  # compliance of the servo over the gear's
OWN_HZ = (10.0, 90.0)  # of the rotor on its servo
RATIO = (0.25, 1.0)  # damping ratio of that
DELAY_S = (0.0, 2e-3)
BRAKE = 300.0  # times as stiff as the servo


def where(drawn: Everyday) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Replace the drive's law by gear and servo in series, exact in frequency."""
    parts, rng = kit.parts, kit.rng
    drive = parts.drives[place]
    gear, own = drive.stiffness, drive.law
    stiffness = gear / size
    omega = 2.0 * np.pi * float(rng.uniform(*OWN_HZ))
    rotor = stiffness / omega**2
    damping = 2.0 * float(rng.uniform(*RATIO)) * stiffness / omega
    delay = float(rng.uniform(*DELAY_S))

    def law(s: Complex) -> Complex:
        held = stiffness * (BRAKE if parts.braked else 1.0)
        control = (held + damping * s) * np.exp(-s * delay)
        before, behind = gear + own(s), rotor * s**2 + control
        series: Complex = before * behind / (before + behind) - gear
        return series

    drive.law = law
    return {
        "servo_stiffness_n_m_per_rad": stiffness,
        "servo_damping_n_m_s_per_rad": damping,
        "inertia_kg_m2": rotor,
        "delay_s": delay,
    }
