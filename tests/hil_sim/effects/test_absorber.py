"""A mass that swings along a line of a link."""

import numpy as np
import pytest
from support.plain_plants import LENGTH, MASS, OWN, K, chain, frequencies, hertz, motion_of

INERTIA = OWN + MASS * LENGTH**2
ROUNDED = 1e-7  # both sides are, and a seat is not free of all loss


def swinging(direction, **more):
    table = {
        "kind": "absorber",
        "link": "link_1",
        "position_m": (0.4, 0.0, 0.0),
        "direction": direction,
        "mass_kg": 0.8,
        "frequency_hz": 9.0,
        "damping_ratio": 0.05,
    }
    return motion_of(chain("z", effects=[table | more]))


def test_along_the_link_s_motion_two_masses_swing_on_two_springs():
    k = 0.8 * (2.0 * np.pi * 9.0) ** 2
    two = hertz(np.diag([INERTIA, 0.8]), np.array([[K + k * 0.16, -k * 0.4], [-k * 0.4, k]]))
    assert frequencies(swinging((0.0, 2.0, 0.0))) == pytest.approx(np.sort(two), rel=ROUNDED)


def test_across_it_the_mass_is_carried_and_swings_by_itself():
    carried = hertz(np.array([[INERTIA + 0.8 * 0.16]]), np.array([[K]]))
    for direction in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        found = frequencies(swinging(direction))
        assert found == pytest.approx(np.sort([*carried, 9.0]), rel=ROUNDED)


def test_its_damper_is_told_by_the_critical_one():
    c = 2.0 * 0.05 * 0.8 * 2.0 * np.pi * 9.0
    more = swinging((0.0, 1.0, 0.0)).damping - swinging((0.0, 1.0, 0.0), damping_ratio=0.0).damping
    assert more == pytest.approx(c * np.array([[0.16, -0.4], [-0.4, 1.0]]), rel=ROUNDED)
