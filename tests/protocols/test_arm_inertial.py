from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.arm.inertial import merge_bodies, physical_link
from armodal.protocols.errors import ArmError

coordinate = st.floats(-1.0, 1.0)
particles = st.lists(
    st.tuples(st.floats(0.1, 10.0), coordinate, coordinate, coordinate), min_size=4, max_size=8
)


def body_of(
    masses_points: list[tuple[float, float, float, float]],
) -> tuple[float, np.ndarray, np.ndarray]:
    m = np.array([p[0] for p in masses_points])
    r = np.array([p[1:] for p in masses_points])
    center = m @ r / m.sum()
    d = r - center
    inertia = sum(
        (mi * (di @ di * np.eye(3) - np.outer(di, di)) for mi, di in zip(m, d, strict=True)),
        start=np.zeros((3, 3)),
    )
    return float(m.sum()), center, inertia


@given(particles, particles)
def test_bodies_merge_as_the_particles_they_are_made_of(
    first: list[tuple[float, float, float, float]], second: list[tuple[float, float, float, float]]
) -> None:
    # Point masses alone may lie on a line; small spheres keep the inertia definite.
    sphere = 1e-3 * np.eye(3)
    bodies = [body_of(first), body_of(second)]
    solid = [(m, c, inertia + sphere) for m, c, inertia in bodies]
    merged = merge_bodies("a", solid)
    mass, center, inertia = body_of(first + second)
    # Sums of some twenty terms up to 10, rounded.
    np.testing.assert_allclose(merged.mass_kg, mass, rtol=1e-13)
    np.testing.assert_allclose(merged.center_m, center, atol=1e-13)
    np.testing.assert_allclose(merged.inertia_kg_m2, inertia + 2 * sphere, atol=1e-11)


def test_a_thin_plate_meets_the_triangle_exactly_and_passes() -> None:
    link = physical_link("plate", 1.0, [0.0, 0.0, 0.0], np.diag([0.01, 0.02, 0.03]))
    assert link.inertia_kg_m2[2, 2] == 0.03


@pytest.mark.parametrize("mass", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_masses_are_refused(mass: float) -> None:
    with pytest.raises(ArmError, match="link a: wanted a mass above 0 kg"):
        physical_link("a", mass, [0.0, 0.0, 0.0], np.eye(3))


def test_values_that_are_not_finite_are_refused() -> None:
    with pytest.raises(ArmError, match="link a: wanted finite centre and inertia"):
        physical_link("a", 1.0, [np.nan, 0.0, 0.0], np.eye(3))
    with pytest.raises(ArmError, match="link a: wanted finite centre and inertia"):
        physical_link("a", 1.0, [0.0, 0.0, 0.0], np.full((3, 3), np.nan))
