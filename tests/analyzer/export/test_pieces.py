"""Pieces of a link that are bodies."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from armodal.analyzer.export.pieces import Piece, physical_pieces


def whole(pieces):
    """Mass, first moment and inertia about the origin."""
    mass = sum(p.mass_kg for p in pieces)
    first = sum(p.mass_kg * p.center_m for p in pieces)
    inertia = sum(
        p.inertia_kg_m2
        + p.mass_kg * (p.center_m @ p.center_m * np.eye(3) - np.outer(p.center_m, p.center_m))
        for p in pieces
    )
    return mass, first, inertia


def cut(moments, length_m, *, turn=(0.3, -0.4, 0.8)):
    """A link of 4 kg with these moments about its centre, in even pieces along a line of it."""
    R = Rotation.from_rotvec(turn).as_matrix()
    masses = 4.0 * np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
    offsets = length_m * np.array([-5.0, -2.0, 2.0, 5.0])[:, None] / 12.0 * R[:, 0]
    inertia = R @ np.diag(moments) @ R.T
    inertia -= sum(
        m * (o @ o * np.eye(3) - np.outer(o, o)) for m, o in zip(masses, offsets, strict=True)
    )
    return [
        Piece(mass_kg=m, center_m=np.array([0.1, 0.2, 0.3]) + o, inertia_kg_m2=m / 4.0 * inertia)
        for m, o in zip(masses, offsets, strict=True)
    ]


def is_body(piece):
    moments = np.linalg.eigvalsh(piece.inertia_kg_m2)
    return moments[0] > 0.0 and moments[0] + moments[1] >= moments[2]


def test_pieces_that_are_bodies_stay_as_they_are():
    pieces = cut((0.05, 0.09, 0.1), 0.2)
    assert all(map(is_body, pieces))
    assert physical_pieces(pieces) == pieces


@pytest.mark.parametrize("length_m", [0.4, 0.6, 1.0])
def test_a_link_as_a_whole_keeps_its_mass_centre_and_inertia(length_m):
    pieces = cut((0.05, 0.06, 0.07), length_m)
    assert not all(map(is_body, pieces))
    found = physical_pieces(pieces)
    assert all(map(is_body, found))
    for there, here in zip(whole(found), whole(pieces), strict=True):
        # The floor under moments, 1e-9 of the largest, and what is left along the line.
        np.testing.assert_allclose(there, here, atol=1e-7)
    # Nearer together, on the same line.
    wide, near = (np.ptp([p.center_m for p in own], axis=0) for own in (pieces, found))
    assert np.linalg.norm(near) < np.linalg.norm(wide)
    np.testing.assert_allclose(np.cross(near, wide), 0.0, atol=1e-9)


def test_a_piece_alone_that_is_no_body_is_raised_to_one():
    piece = Piece(mass_kg=1.0, center_m=np.zeros(3), inertia_kg_m2=np.diag([0.1, 0.2, 0.4]))
    (found,) = physical_pieces([piece])
    assert is_body(found)
    np.testing.assert_allclose(found.center_m, 0.0)
