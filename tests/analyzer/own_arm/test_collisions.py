"""Collisions of an arm of boxes, against distances that geometry tells."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from support.robot_files import LinkText, RobotText, six_joints

from armodal.analyzer.own_arm.collisions import Collisions
from armodal.analyzer.own_arm.draft import Wanted, draft_arm
from armodal.analyzer.own_arm.meshes import coal
from armodal.analyzer.own_arm.solids import hull_solid, touches, triangle_solid
from armodal.analyzer.own_arm.surface import Surface
from armodal.analyzer.planning.room import Room
from armodal.analyzer.planning.route import route, wound
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import KeepOut
from armodal.protocols.robot.remarks import Remarks


@pytest.fixture(scope="module")
def flat():
    """Three bars of 0.4 m in a plane, 60 mm square; the last can fold back onto the base."""
    bar, at, next_ = (0.4, 0.06, 0.06), (0.2, 0.0, 0.0), (0.4, 0.0, 0.0)
    return RobotText(
        [LinkText(name, bar, at, next_, limit=(-3.1, 3.1)) for name in ("first", "second", "third")]
    )


@pytest.fixture(scope="module")
def draft(flat, tmp_path_factory):
    path = flat.write(tmp_path_factory.mktemp("flat") / "flat.urdf")
    return draft_arm(path, "flat", Wanted(), Remarks())


def test_bars_that_cross_are_told_and_named(draft):
    room = Collisions(draft.arm, draft.bodies)
    # An equilateral triangle of 0.4 m: the third bar ends where the first begins.
    turn = 2 * np.pi / 3
    folded = np.array([0.0, turn, turn])
    assert room.met(folded) == ("base_link and third", "first and third")
    assert room.clear([[0.0, 0.0, 0.0], folded]).tolist() == [True, False]
    assert room.touching == ()


def test_the_margin_stands_between_hulls(draft):
    room = Collisions(draft.arm, draft.bodies)
    # A box beside the stretched third bar, whose face is 30 mm from the axis.
    for gap, free in ((1.5 * room.margin_m, True), (0.5 * room.margin_m, False)):
        beside = KeepOut(
            name="post",
            low_m=np.array([0.9, 0.03 + gap, 0.0]),
            high_m=np.array([1.1, 0.2, 0.3]),
        )
        here = Collisions(draft.arm, draft.bodies, [beside])
        assert here.clear([np.zeros(3)]).tolist() == [free]
    assert here.met(np.zeros(3)) == ("post and third",)


def test_hulls_that_are_apart_are_meshes_that_are_apart(tmp_path):
    """Postures taken for free, against the triangles themselves and without any margin."""
    draft = draft_arm(six_joints().write(tmp_path / "a.urdf"), "a", Wanted(), Remarks())
    room = Collisions(draft.arm, draft.bodies, draft.arm.keep_outs)
    rng = np.random.default_rng(3)
    q = rng.uniform(-2.5, 2.5, size=(300, 6))
    free = q[room.clear(q)]
    assert 30 < len(free) < 270
    solids = [[triangle_solid(shell) for shell in body.shells] for body in draft.bodies]
    for posture in free[:40]:
        poses = [np.eye(4)] + [
            link_pose(draft.arm, joint.link.name, posture) for joint in draft.arm.joints
        ]
        for i in range(len(solids)):
            for j in range(i + 2, len(solids)):
                T = np.linalg.inv(poses[i]) @ poses[j]
                assert not any(touches(a, b, T) for a in solids[i] for b in solids[j])


def test_a_disc_of_hundreds_of_corners_is_a_hull_too():
    angles = np.linspace(0.0, 2.0 * np.pi, 600, endpoint=False)
    ring = np.column_stack([0.1 * np.cos(angles), 0.1 * np.sin(angles), np.zeros(600)])
    disc = Surface(
        np.concatenate([ring, [[0.0, 0.0, 0.05], [0.0, 0.0, -0.05]]]),
        np.array([[i, (i + 1) % 600, 600] for i in range(600)]),
    )
    solid, ball = hull_solid(disc), coal().Sphere(0.01)
    for height, meets in ((0.059, True), (0.061, False)):
        T = np.eye(4)
        T[2, 3] = height
        assert touches(solid, ball, T) == meets


def test_a_hand_does_not_reach_a_face_that_another_body_covers(draft):
    room = Collisions(draft.arm, draft.bodies, draft.arm.keep_outs)
    stretched = room.reachable(np.zeros(3), draft.arm.points)
    # The first bar turned back under nothing: all that moves is reached when it is stretched.
    assert {point.id for point in draft.arm.points if point.link == "third"} <= stretched
    near = KeepOut(name="wall", low_m=np.array([-2.0, 0.1, -1.0]), high_m=np.array([2.0, 0.3, 1.0]))
    walled = Collisions(draft.arm, draft.bodies, [near])
    towards = {
        point.id
        for point in draft.arm.points
        if point.link != "base"
        and (link_pose(draft.arm, point.link, np.zeros(3))[:3, :3] @ point.R_link_sensor)[1, 2]
        > 0.9
    }
    assert towards
    assert not towards & walled.reachable(np.zeros(3), draft.arm.points)


def test_a_way_goes_round_what_stands_in_it(draft):
    post = KeepOut(
        name="post", low_m=np.array([0.95, -0.1, -0.5]), high_m=np.array([1.05, 0.1, 0.5])
    )
    collisions = Collisions(draft.arm, draft.bodies, [post])
    room = Room(
        free=collisions.clear,
        reachable=lambda q: collisions.reachable(q, draft.arm.points),
        path_clear=collisions.path_clear,
    )
    start, end = np.array([-0.6, 0.0, 0.0]), np.array([0.6, 0.0, 0.0])
    assert collisions.clear([start, end]).all()
    (leg,) = route(draft.arm, [start, end], room, np.random.default_rng(0))
    assert leg.stops_rad
    for a, b in pairwise((start, *leg.stops_rad, end)):
        between = a + np.linspace(0.0, 1.0, 400)[:, None] * (b - a)
        assert collisions.clear(between).all()


def test_a_posture_is_wound_to_the_nearest_turn_within_its_range(draft):
    q = np.array([3.0, -3.0, 0.5])
    # Ranges are ±3.1: only -3.0 + 2 pi would leave them.
    np.testing.assert_allclose(wound(draft.arm, q, np.zeros(3)), q)
