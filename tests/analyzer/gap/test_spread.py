"""Where pieces of a link lie, against links whose inertia is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.gap.model.spread import apart
from armodal.analyzer.gap.model.system import Pieces
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


def test_pieces_of_a_slender_rod_lie_all_along_it_whichever_way_it_is_cut():
    rod = link(np.diag([0.0, 0.12, 0.12]))
    askew = np.array([np.cos(0.3), 0.0, np.sin(0.3)])  # as to a next joint beside the rod's end
    places = 0.5 * MIDDLES
    for along in (np.eye(3)[0], askew):
        offsets = apart(rod, along, SHARES, places)
        assert offsets @ along == pytest.approx(places)
        assert offsets[:, 1:] == pytest.approx(np.zeros((4, 2)), abs=1e-15)


def test_halves_of_an_ellipsoid_lie_where_a_cut_askew_leaves_them():
    """Sampled: of points inside, those beyond a plane through the middle."""
    rng = np.random.default_rng(7)
    axes = np.array([0.3, 0.1, 0.05])
    points = rng.uniform(-1.0, 1.0, (400_000, 3))
    points = axes * points[np.sum(points**2, axis=1) < 1.0]
    along = np.array([2.0, 1.0, 2.0]) / 3.0
    at = points @ along
    beyond = points[at > 0.0]
    S = points.T @ points / len(points) * 4.0
    body = link(np.trace(S) * np.eye(3) - S)
    place = float(beyond.mean(axis=0) @ along)
    halves = apart(body, along, np.array([0.5, 0.5]), np.array([-place, place]))
    # Of 200 000 points a mean is known to a standard error of 0.1 / sqrt(200 000) m.
    assert halves[1] == pytest.approx(beyond.mean(axis=0), abs=5.0 * 0.1 / np.sqrt(2e5))


def test_two_masses_at_the_ends_of_a_rod_may_lie_as_far_apart_as_they_are():
    """A dumbbell's second moment along its line is all there is to spread: m a²."""
    a = 0.2
    dumbbell = link(np.diag([0.0, 4.0 * a**2, 4.0 * a**2]))
    offsets = apart(dumbbell, np.eye(3)[0], np.array([0.5, 0.5]), np.array([-1.0, 1.0]))
    assert offsets[1, 0] == pytest.approx(a, rel=1e-3)


@given(
    st.tuples(*[st.floats(0.01, 1.0)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda u: np.linalg.norm(u) > 0.1),
    st.floats(0.01, 3.0),
)
def test_what_pieces_keep_is_a_bodys_and_they_come_no_nearer_than_that_takes(semi, line, length):
    x, y, z = np.square(semi) * 4.0 / 5.0  # second moments of an ellipsoid of 4 kg
    body = link(np.diag([y + z, x + z, x + y]))
    along = np.array(line) / np.linalg.norm(line)
    offsets = apart(body, along, SHARES, length * MIDDLES)
    least = min(np.linalg.eigvalsh(S)[0] for S in second_moments(body, offsets))
    assert least >= 0.0
    if offsets[-1] @ along < 0.999 * length * MIDDLES[-1]:
        further = second_moments(body, 1.01 * offsets)
        assert min(np.linalg.eigvalsh(S)[0] for S in further) < 0.0
