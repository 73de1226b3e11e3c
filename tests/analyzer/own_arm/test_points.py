"""Points on an arm's bodies: outside, flat, spread."""

from __future__ import annotations

import numpy as np
import pytest

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.meshes import shape_triangles
from armodal.analyzer.own_arm.points import FLAT_M, FOOT_M, body_points, flat_normal
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.robot.records import Shape
from armodal.protocols.robot.remarks import Remarks


def shape(kind, *size, at=(0.0, 0.0, 0.0)):
    T = np.eye(4)
    T[:3, 3] = at
    return Surface(*shape_triangles(Shape(kind=kind, size_m=size, T_link_shape=T)))


def together(*surfaces):
    offsets = np.cumsum([0, *(len(one.vertices_m) for one in surfaces)])[:-1]
    return Surface(
        np.concatenate([one.vertices_m for one in surfaces]),
        np.concatenate([one.triangles + off for one, off in zip(surfaces, offsets, strict=True)]),
    )


def body(surface):
    return ArmBody(name="b", cut=None, seen=surface, shells=(surface,), drawn=True, inertial=None)


def points_on(surface, said=None):
    found = body_points(
        [body(shape("box", 0.2, 0.2, 0.1)), body(surface)],
        np.random.default_rng(0),
        said or Remarks(),
    )
    return [point for point in found if point.body == 1]


def test_points_lie_on_the_outside_with_outward_normals_and_see_six_motions():
    size = np.array([0.3, 0.1, 0.08])
    inner = shape("box", 0.2, 0.05, 0.04)  # as a motor drawn inside a housing
    found = points_on(together(shape("box", *size), inner))
    assert len(found) == 4
    rows = []
    for point in found:
        axis = int(np.argmax(np.abs(point.normal)))
        assert point.normal[axis] * point.position_m[axis] == pytest.approx(
            size[axis] / 2, rel=1e-6
        )
        assert point.x_axis @ point.normal == pytest.approx(0.0, abs=1e-12)
        x, y, z = point.position_m / 0.15
        rows.append(np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]]))
    told = np.linalg.eigvalsh(np.concatenate(rows).T @ np.concatenate(rows))
    assert told[0] > 0.1  # of 4, what a perfectly spread motion has


def test_short_and_long_bodies_have_three_and_five_points():
    assert len(points_on(shape("box", 0.1, 0.08, 0.08))) == 3
    assert len(points_on(shape("cylinder", 0.06, 0.5))) == 5


def test_a_foot_is_flat_on_a_face_and_a_wide_tube_and_not_on_an_edge_or_a_thin_rod():
    box = shape("box", 0.1, 0.1, 0.1)
    up = np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(flat_normal(box, np.array([0.01, 0.0, 0.05]), up), up, atol=1e-9)
    edge = np.array([0.05 - 0.4 * FOOT_M, 0.0, 0.05])
    assert flat_normal(box, edge, up) is None
    # On a tube of radius R the foot's rim lies FOOT²/2R deep, half of it off the mean plane.
    fits = 0.5 * FOOT_M**2 / (2 * FLAT_M)
    for radius, flat in ((8.0 * fits, True), (0.5 * fits, False)):
        tube = shape("cylinder", radius, 0.2)
        place = (
            radius * np.cos(np.pi / 24) * np.array([np.cos(np.pi / 24), np.sin(np.pi / 24), 0.0])
        )
        normal = place / np.linalg.norm(place)
        assert (flat_normal(tube, place, normal) is not None) == flat


def test_a_body_without_a_flat_place_is_a_fault():
    said = Remarks()
    assert points_on(shape("sphere", 0.004), said) == []
    assert "found 0" in str(said.of("fault")[0])


def test_a_thin_rod_has_its_points_on_curved_places_and_that_is_said():
    said = Remarks()
    # 21 mm across, so that the rim of a foot lies 1.3 mm deep.
    found = points_on(shape("capsule", 0.0105, 0.035), said)
    assert len(found) == 3
    assert "use an adapter" in str(said.of("note")[0])
    assert said.of("fault") == ()
