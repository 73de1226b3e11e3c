"""How far apart pieces of a link may lie, against links whose inertia is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.gap.model.assembly import Pieces
from armodal.analyzer.gap.model.spread import nearer
from armodal.protocols.arm.records import InertialLink

SHARES = np.array([1, 2, 2, 1]) / 6.0
MIDDLES = np.array([-5.0, -2.0, 2.0, 5.0]) / 12.0


def link(inertia, mass=4.0):
    return InertialLink(
        name="link", mass_kg=mass, center_m=np.zeros(3), inertia_kg_m2=np.array(inertia)
    )


def second_moments(body, offsets):
    """Of each piece about its own centre."""
    spatial = np.zeros((6, 6))
    spatial[:3, :3], spatial[3:, 3:] = body.mass_kg * np.eye(3), body.inertia_kg_m2
    pieces = Pieces(shares=SHARES, offsets_m=offsets, motion=np.zeros((4, 6, 0)))
    for share, offset, own in zip(SHARES, offsets, pieces.split(spatial), strict=True):
        mass = share * body.mass_kg
        J = own[3:, 3:] - mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
        yield 0.5 * np.trace(J) * np.eye(3) - J


def test_pieces_of_a_slender_rod_lie_all_along_it():
    rod = link(np.diag([1e-4, 0.12, 0.12]))
    offsets = np.outer(0.5 * MIDDLES, [1.0, 0.0, 0.0])
    assert nearer(rod, SHARES, offsets) == 1.0


def test_two_masses_at_the_ends_of_a_rod_may_lie_as_far_apart_as_they_are():
    """A dumbbell's second moment along its line is all there is to spread: m a²."""
    a = 0.2
    dumbbell = link(np.diag([0.0, 4.0 * a**2, 4.0 * a**2]))
    offsets = np.outer([-1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    shares = np.array([0.5, 0.0, 0.0, 0.5])
    assert nearer(dumbbell, shares, offsets) == pytest.approx(a, rel=1e-3)


@given(
    st.tuples(*[st.floats(0.01, 1.0)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda u: np.linalg.norm(u) > 0.1),
    st.floats(0.01, 3.0),
)
def test_what_pieces_keep_is_a_bodys_and_they_come_no_nearer_than_that_takes(semi, line, length):
    x, y, z = np.square(semi) * 4.0 / 5.0  # second moments of an ellipsoid of 4 kg
    body = link(np.diag([y + z, x + z, x + y]))
    offsets = np.outer(length * MIDDLES, np.array(line) / np.linalg.norm(line))
    part = nearer(body, SHARES, offsets)
    least = min(np.linalg.eigvalsh(S)[0] for S in second_moments(body, part * offsets))
    assert least >= 0.0
    if part < 1.0:
        further = second_moments(body, 1.01 * part * offsets)
        assert min(np.linalg.eigvalsh(S)[0] for S in further) < 0.0
