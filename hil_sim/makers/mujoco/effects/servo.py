"""A servo that gives way behind the gear, with the rotor's inertia."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis, Servo
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.01, 3.0)  # servo compliance over the gear's
OWN_HZ = (12.0, 70.0)  # of rotor on servo alone
DAMPING_RATIO = (0.2, 0.9)  # of rotor on servo alone, before the delay takes from it
DELAY_S = (0.0, 1.5e-3)


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Put the rotor on its servo, before the gear's spring.

    To first order a delay takes delay times stiffness from the servo's damping.
    """
    rng, drive = rig.rng, rig.drive(place)
    stiffness, omega = drive.stiffness / size, 2.0 * np.pi * float(rng.uniform(*OWN_HZ))
    inertia = stiffness / omega**2
    delay = float(rng.uniform(*DELAY_S))
    damping = 2.0 * float(rng.uniform(*DAMPING_RATIO)) * stiffness / omega
    damping = max(damping - delay * stiffness, 0.05 * damping)
    body = rig.machine.moved_by(place)
    body.axes.insert(
        body.axes.index(drive),
        Axis(
            name=f"rotor {place}",
            direction=drive.direction,
            at_m=drive.at_m,
            stiffness=0.0,
            damping=0.0,
            inertia=inertia,
        ),
    )
    rig.machine.servos.append(Servo(axis=f"rotor {place}", stiffness=stiffness, damping=damping))
    return {
        "servo_stiffness_n_m_per_rad": stiffness,
        "servo_damping_n_m_s_per_rad": damping,
        "inertia_kg_m2": inertia,
        "delay_s": delay,
    }
