"""A servo of the frame damps its rotor: an arm whose loop drives it would not stand still."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.quick import few_quick

from armodal.hil_sim.makers.frame.effects import servo
from armodal.hil_sim.streams import stream

GEAR = 4e4  # N m/rad


@pytest.mark.parametrize("size", few_quick([0.05, 0.5, 4.0], 0.05, 4.0))
def test_its_rotor_on_gear_and_loop_comes_to_rest(size):
    """No zero to the right of the axis: along it the argument turns by +180 degrees (Nyquist)."""
    for number in range(100):
        drive = SimpleNamespace(stiffness=GEAR, law=lambda s: 0.0 * s)
        parts = SimpleNamespace(drives={"A1": drive}, braked=False)
        told = servo.hide(SimpleNamespace(parts=parts, rng=stream(number, "servo")), "A1", size)
        K, D, inertia, delay = (
            told[name]
            for name in (
                "servo_stiffness_n_m_per_rad",
                "servo_damping_n_m_s_per_rad",
                "inertia_kg_m2",
                "delay_s",
            )
        )
        s = 1j * np.linspace(0.0, 10.0 * np.sqrt((K + GEAR) / inertia), 20_000)
        held = inertia * s**2 + GEAR + (K + D * s) * np.exp(-s * delay)
        assert np.unwrap(np.angle(held))[-1] > 0.5 * np.pi
