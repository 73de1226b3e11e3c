"""Places by three distances, against the places they were measured at."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.chain_arm import chain_arm

from armodal.analyzer.own_arm.moving import by_distances
from armodal.analyzer.own_arm.towards import step_towards
from armodal.analyzer.own_arm.typed_move import typed_move
from armodal.protocols.errors import ArmError

KNOWN = [np.array(place) for place in ([0.1, 0.0, 0.0], [0.0, 0.3, 0.1], [-0.2, 0.1, 0.2])]
coordinate = st.floats(-0.5, 0.5)


@given(st.tuples(coordinate, coordinate, coordinate))
def test_one_of_the_two_places_is_the_measured_one(place):
    target = np.array(place)
    distances = [float(np.linalg.norm(target - one)) for one in KNOWN]
    found = by_distances(KNOWN, distances, "point")
    # Near the plane of the three the height is the root of a small difference of squares.
    assert np.linalg.norm(found - target, axis=1).min() < 1e-6


def test_distances_that_no_place_has_and_three_points_on_a_line_are_refused():
    with pytest.raises(ArmError, match="no place has the distances 10, 10, 10 mm"):
        by_distances(KNOWN, [0.01, 0.01, 0.01], "point 7")
    line = [np.array([x, 0.0, 0.0]) for x in (0.0, 0.1, 0.2)]
    with pytest.raises(ArmError, match="not on one line"):
        by_distances(line, [0.1, 0.1, 0.1], "point 7")


def test_what_is_typed_moves_a_point_along_its_sensor_towards_another_and_to_its_distances():
    arm = chain_arm(2)
    old, near, *_ = (point for point in arm.points if point.link == "link 1")
    # Nothing is drawn of this arm: the point goes where it is told, and keeps its axes.
    moved = typed_move(arm, None, old.id, "20, -10")
    x, y, _ = old.R_link_sensor.T
    np.testing.assert_allclose(moved.position_m, old.position_m + 0.02 * x - 0.01 * y, atol=1e-12)
    np.testing.assert_array_equal(moved.R_link_sensor, old.R_link_sensor)
    way = near.position_m - old.position_m
    moved = typed_move(arm, None, old.id, f"{near.id}:30")
    np.testing.assert_allclose(
        moved.position_m, old.position_m + 0.03 * way / np.linalg.norm(way), atol=1e-12
    )


@pytest.mark.parametrize("joint", [1, 2])
def test_a_point_comes_nearer_to_the_axis_of_a_joint_at_either_end_by_what_is_typed(joint):
    arm = chain_arm(2)
    old = next(point for point in arm.points if point.link == "link 1")
    near, far = arm.joints
    origin, axis = np.zeros(3), near.axis
    if joint == 2:
        T = far.T_parent_joint
        origin, axis = T[:3, 3], T[:3, :3] @ far.axis

    def distance(place):
        return float(np.linalg.norm(np.cross(axis, place - origin)))

    moved = typed_move(arm, None, old.id, f"J{joint}:5")
    assert distance(old.position_m) - distance(moved.position_m) == pytest.approx(0.005)
    by_name = step_towards(arm, old, arm.joints[joint - 1].name, 0.005)
    np.testing.assert_allclose(by_name, moved.position_m - old.position_m, atol=1e-15)


def test_a_joint_that_is_not_at_the_links_ends_is_refused_by_those_that_are():
    arm = chain_arm(3)
    point = next(point for point in arm.points if point.link == "link 1")
    with pytest.raises(ArmError, match=r"a joint at its ends"):
        typed_move(arm, None, point.id, "J3:10")


@pytest.mark.parametrize("typed", ["", "20", "far", "1:2:3", "20 nan", "4:30", "9:30", "1:3 2:3"])
def test_words_that_name_no_place_are_refused(typed):
    arm = chain_arm(2)
    with pytest.raises(ArmError, match="wanted"):
        typed_move(arm, None, "1", typed)
