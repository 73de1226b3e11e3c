"""Plans that can be run: free, reachable, with equipment, time and what the inertias leave."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from support.robot_files import six_joints

from armodal.analyzer.own_arm.collisions import Collisions
from armodal.analyzer.own_arm.draft import Wanted, draft_arm
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.equipment import chosen_equipment
from armodal.analyzer.planning.fewer_points import observable_motions
from armodal.analyzer.planning.made import made_plan
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.errors import EstimateError, PlanError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE, load_equipment

pytestmark = pytest.mark.usefixtures("small_search")


@pytest.fixture(scope="module")
def draft(tmp_path_factory):
    path = six_joints().write(tmp_path_factory.mktemp("six") / "six.urdf")
    return draft_arm(path, "six", Wanted(), Remarks())


def planned(draft, **settings):
    return made_plan(
        draft.arm,
        np.random.default_rng(0),
        **{
            "name": "tests",
            "bodies": draft.bodies,
            "floor_m": None,
            "equipment": CATALOGUE,
            "n_tests": 4,
        }
        | settings,
    )


def chosen(arm, equipment):
    postures = random_postures(arm, 20, np.random.default_rng(0))
    return chosen_equipment(planned_arm(arm), postures, equipment)


@pytest.fixture(scope="module")
def made(draft):
    return planned(draft)


def test_planned_postures_are_free_and_their_points_reached(draft, made):
    plan = plan_from_text(made.text, draft.arm)
    assert plan.sensor.mass_kg == made.equipment.accelerometer.mass_kg
    assert plan.trigger.level_n == made.equipment.trigger_n
    room = Collisions(draft.arm, draft.bodies, draft.arm.keep_outs)
    q = np.array([posture.joints_rad for posture in plan.postures])
    assert room.clear(q).all()
    for posture in plan.postures:
        near = room.reachable(posture.joints_rad, draft.arm.points)
        assert set(posture.points) <= near
        assert plan.fixed_point in near
        assert any(draft.arm.point(point).link == "base" for point in posture.points)
    for start, end, leg in zip(q[:-1], q[1:], made.legs, strict=True):
        assert leg.stops_rad is not None
        stops = leg.stops_rad
        assert all(room.path_clear(a, b) for a, b in pairwise((start, *stops, end)))


def test_a_heavier_arm_gets_a_heavier_hammer_and_a_higher_trigger(made, tmp_path):
    robot = six_joints()
    for link in robot.links:
        link.box_m = tuple(3 * side for side in link.box_m)
        link.center_m = tuple(3 * side for side in link.center_m)
        link.next_m = tuple(3 * side for side in link.next_m)
    path = robot.write(tmp_path / "large.urdf")
    large = chosen(draft_arm(path, "large", Wanted(), Remarks()).arm, CATALOGUE)
    small = made.equipment
    assert large.mass_met_kg > 10 * small.mass_met_kg  # volumes are 27 times as large
    assert large.hammer.head_kg > small.hammer.head_kg
    assert large.peak_n > small.peak_n
    assert 0.04 * large.peak_n < large.trigger_n <= 0.1 * large.peak_n
    assert large.peak_n / large.mass_met_kg <= 0.5 * large.accelerometer.range_m_s2


def test_the_inertias_tolerance_is_that_of_the_joint_s_own_moment(draft, made):
    """Each link's mass off by its tolerance, independent: sampled, against the sum of squares."""
    rng = np.random.default_rng(5)
    plan, arm = made.plan, draft.arm
    t = arm.tolerances
    i = 1
    joint = plan.elastic.joints[i]
    fitted = plan.tests[: plan.n_fitted]
    shown = [test for test in fitted if joint in test.serves or joint == test.target]
    scatter = []
    for test in shown:
        q = test.joints_rad[None]
        own = ArmBatch(arm).mass(q)[joint, joint, 0]
        moved = []
        for _ in range(60):
            links = []
            for each in arm.joints:
                link = each.link
                scale = 1 + t.mass * rng.normal()
                moments, axes = np.linalg.eigh(link.inertia_kg_m2)
                moments = moments * scale * (1 + t.inertia * rng.normal(size=3))
                links.append(
                    type(link)(
                        name=link.name,
                        mass_kg=link.mass_kg * scale,
                        center_m=link.center_m + t.center_m * rng.normal(size=3),
                        inertia_kg_m2=axes @ np.diag(moments) @ axes.T,
                    )
                )
            moved.append(ArmBatch(arm).with_links(links).mass(q)[joint, joint, 0] / own)
        scatter.append(np.std(moved))
    # 60 draws tell a deviation to 9 %; three of these. The encoders' share is below that.
    assert made.inertia_std[i] == pytest.approx(min(scatter), rel=0.27)


def test_minutes_are_those_of_postures_mountings_and_hits(draft, made):
    plan = plan_from_text(made.text, draft.arm)
    # A posture takes 3 minutes, a point 75 s and three hits of 8 s and their records of 2 s.
    points = sum(len(posture.points) for posture in plan.postures)
    assert made.minutes == pytest.approx(3.0 * len(plan.postures) + 1.75 * points)


def test_the_last_of_four_tests_is_for_validation(draft, made):
    plan = plan_from_text(made.text, draft.arm)
    held_out = [posture.validation for posture in plan.postures]
    assert held_out[-1]
    assert not any(held_out[:-1])
    # What is told of k after it is told by the others alone.
    assert len(made.plan.expected_std) == len(plan.postures) - 1 >= made.plan.n_needed


@pytest.mark.long
def test_none_of_three_tests_is_for_validation(draft):
    three = planned(draft, n_tests=3)
    assert not any(p.validation for p in plan_from_text(three.text, draft.arm).postures)


@pytest.mark.long
def test_a_short_plan_still_shows_the_motions_of_every_link(draft, made):
    """By the rank of the points' rigid motions in the base frame, worked out here."""
    arm, limit = draft.arm, made.minutes - 20.0
    short = planned(draft, minutes=limit)
    assert limit - 1.75 < short.minutes <= limit  # a mounting takes 1.75 minutes
    plan, full = (plan_from_text(text, arm) for text in (short.text, made.text))
    on = {point.id: point.link for point in arm.points}

    def rank(link, posture):
        rows = [
            np.hstack([np.eye(3), np.cross(np.eye(3), 10.0 * arm.point(p).position_m)])
            for p in posture.points
            if on[p] == link
        ]
        return np.linalg.matrix_rank(np.vstack(rows), tol=0.01) if rows else 0

    for link in set(on.values()):
        fitted = [[p for p in each.postures if not p.validation] for each in (plan, full)]
        assert max(rank(link, p) for p in fitted[0]) == max(rank(link, p) for p in fitted[1])
    for posture, whole in zip(plan.postures, full.postures, strict=True):
        assert plan.fixed_point in posture.points
        assert {on[p] for p in posture.points} == {on[p] for p in whole.points}
    # Fewer points cannot tell more; 1e-6 is the rounding of the inverse.
    assert (short.plan.expected_std >= (1 - 1e-6) * made.plan.expected_std).all()


def test_a_plan_that_cannot_be_so_short_is_refused_with_the_minutes_it_takes(draft):
    with pytest.raises(PlanError, match=r"at most 10 minutes, got \d+ for 2 tests") as refused:
        planned(draft, n_tests=2, minutes=10.0)
    least = float(str(refused.value).rsplit(" ", 1)[1])
    assert least - 1.0 < planned(draft, n_tests=2, minutes=least).minutes <= least


@pytest.mark.parametrize(
    ("places", "motions"),
    [
        ([], 0),
        ([(0, 0, 0)], 3),
        ([(0, 0, 0), (1, 0, 0)], 5),
        ([(0, 0, 0), (0.5, 0, 0), (1, 0, 0)], 5),
        ([(0, 0, 0), (0.5, 0.01, 0), (1, 0, 0)], 5),  # a lever of a hundredth
        ([(0, 0, 0), (0.5, 0.5, 0), (1, 0, 0)], 6),
    ],
)
def test_six_motions_are_shown_by_three_points_off_one_line(places, motions):
    assert observable_motions([np.array(place, dtype=float) for place in places], 1.0) == motions


def test_a_room_without_a_free_posture_is_told_with_what_meets(draft):
    with pytest.raises(EstimateError, match=r"no posture of arm 'six' is free: .* meet"):
        planned(draft, floor_m=3.0)


SENSORS = """
format = "armodal-sensors-1"
[[hammers]]
name = "ours"
head_kg = 0.2
range_n = 1000.0
[[accelerometers]]
name = "triax"
mass_kg = {mass}
range_m_s2 = {range}
noise_m_s2_per_sqrt_hz = 0.001
"""


def test_a_laboratory_s_own_sensors_are_used_or_refused_with_what_is_wanted(draft, tmp_path):
    path = tmp_path / "sensors.toml"
    path.write_text(SENSORS.format(mass=0.012, range=490.0))
    ours = chosen(draft.arm, load_equipment(path))
    assert (ours.hammer.name, ours.accelerometer.name) == ("ours", "triax")
    path.write_text(SENSORS.format(mass=0.012, range=0.5))
    with pytest.raises(PlanError, match=r"wanted an accelerometer of at most .* with a range of"):
        chosen(draft.arm, load_equipment(path))
    path.write_text(SENSORS.format(mass=-1.0, range=490.0))
    with pytest.raises(PlanError, match=r"accelerometers\[0\]\.mass_kg: wanted greater than 0"):
        load_equipment(path)
