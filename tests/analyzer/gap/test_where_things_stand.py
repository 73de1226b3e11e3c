"""Ordinary errors of place: bearings along their axes, hits beside their point, a base's points."""

from dataclasses import replace

import numpy as np
import pytest
from support.without_errors import without_errors

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.link_axis import splits
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.long_links import span_m
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.priors import BASE_GAIN_STD
from armodal.analyzer.gap.model.weigh import Discrepancy, Weighing

JOINTS = np.deg2rad([10.0, -35.0, 20.0, 15.0, 40.0, 20.0])
STRUCK = 4  # index of the point that is hit


@pytest.fixture(scope="module")
def lines(superset):
    n_points = len(superset.arm.points)
    s = 2 * np.pi * (2.0 + 1j * np.array([8.0, 31.0, 110.0]))
    return PostureLines(
        name="p",
        joints_rad=JOINTS,
        s_rad_s=s,
        sensor_point=np.arange(n_points),
        hit=np.zeros(n_points, dtype=int),
        hit_point=np.array([STRUCK]),
        hit_direction=np.array([[-0.45, -0.62, -0.6427]]),
        values=np.ones((n_points, 3, s.size), dtype=complex),
        variance=np.ones((n_points, 3, s.size)),
        sensor_mass_kg=0.0093,
    )


KINDS = ("bend", "bearing place", "bearing radial", "bearing axial", "hit place", "place")


def roving(lines):
    """The same points with sensor and hammer exchanged; the hits along one direction."""
    n = len(lines.sensor_point)
    return replace(
        lines,
        sensor_point=np.full(n, STRUCK),
        hit=np.arange(n),
        hit_point=lines.sensor_point,
        hit_direction=np.repeat(lines.hit_direction, n, axis=0),
    )


@pytest.fixture(scope="module")
def ordinary(superset):
    points = tuple(point.id for point in superset.arm.points)
    return Ordinary(superset=superset, postures=("p",), hit_points=points)


def predicted(superset, ordinary, lines, instances=(), **values):
    hypothesis = Hypothesis(ordinary=ordinary, instances=instances)
    space = hypothesis.space()
    at = without_errors(space.values(space.start())) | values
    return PosedModel(superset, JOINTS).values(hypothesis, lines, at)


def test_a_bearing_beside_its_frame_is_an_axis_across_the_joint_there(superset, lines, ordinary):
    joint, apart_m, gamma = superset.arm.joints[2], 0.23, 3e-7
    axis = np.asarray(joint.axis)
    crossing = link_axis.at_axis(ordinary, 2, across(axis)[:, 0], apart_m * axis)
    size, loss, factor = (p.name for p in crossing.parameters[:3])
    np.testing.assert_allclose(
        predicted(
            superset,
            ordinary,
            lines,
            **{f"bearing a {joint.name}": gamma, f"bearing place {joint.name}": apart_m},
        ),
        predicted(superset, ordinary, lines, (crossing,), **{size: gamma, loss: 0.0, factor: 0.0}),
        rtol=1e-9,  # the same compliance, reached two ways
    )


def test_hits_beside_their_point_are_those_of_an_arm_whose_point_is_there(
    superset, lines, ordinary
):
    arm, shift_m = superset.arm, np.array([0.004, -0.003, 0.002])
    point = arm.points[STRUCK]
    beside = replace(point, position_m=point.position_m + point.R_link_sensor @ shift_m)
    points = tuple(beside if p is point else p for p in arm.points)
    moved = Superset(replace(arm, points=points))
    names = ordinary.hit_place_names(point.id)
    other = [i for i in range(len(points)) if i != STRUCK]
    np.testing.assert_allclose(
        predicted(superset, ordinary, lines, **dict(zip(names, shift_m, strict=True)))[other],
        predicted(moved, replace(ordinary, superset=moved), lines)[other],
        rtol=1e-9,
    )


def test_so_are_hits_of_a_hammer_that_goes_round(superset, lines, ordinary):
    arm, lines = superset.arm, roving(lines)
    shifts_m = 0.004 * np.random.default_rng(5).standard_normal((len(arm.points), 3))
    points = [
        replace(point, position_m=point.position_m + point.R_link_sensor @ shift_m)
        for point, shift_m in zip(arm.points, shifts_m, strict=True)
    ]
    stays = arm.points[STRUCK]
    points[STRUCK] = stays  # where the sensor is
    moved = Superset(replace(arm, points=tuple(points)))
    values = {
        name: value
        for point, shift_m in zip(arm.points, shifts_m, strict=True)
        if point is not stays
        for name, value in zip(ordinary.hit_place_names(point.id), shift_m, strict=True)
    }
    np.testing.assert_allclose(
        predicted(superset, ordinary, lines, **values),
        predicted(moved, replace(ordinary, superset=moved), lines),
        rtol=1e-9,
    )


@pytest.mark.parametrize(
    ("goes_round", "aside"), [("sensor", 0.3), ("hammer", 0.3), ("sensor", -0.3)]
)
def test_what_they_change_a_unit_is_known(superset, lines, ordinary, goes_round, aside):
    lines = lines if goes_round == "sensor" else roving(lines)
    hypothesis = Hypothesis(ordinary=ordinary)
    space, posed = hypothesis.space(), PosedModel(superset, JOINTS)
    u = np.clip(space.start() + aside, space.low, space.high)
    _, dy = posed.derivatives(hypothesis, lines, space, space.values(u))
    step, acts = 1e-3, 0
    for name, i in space.index.items():
        if not name.startswith(KINDS):
            continue
        more, less = (
            posed.values(hypothesis, lines, space.values(u + sign * step * np.eye(len(u))[i]))
            for sign in (1.0, -1.0)
        )
        want = (more - less) / (2.0 * step)
        # Single precision of the derivatives, seven digits, over products of some hundred terms.
        np.testing.assert_allclose(dy[i], want, atol=1e-3 * np.abs(want).max(), err_msg=name)
        acts += bool(np.any(want))
    # Two ways across of each hit's place, at least; and three of each sensor's.
    n = len(superset.arm.points)
    assert acts >= (3 * n + 2 if goes_round == "sensor" else 3 + 2 * n)


def test_a_point_of_the_base_may_move_half_as_much_more_than_the_base(superset, lines):
    on_base = np.arange(len(lines.sensor_point)) % 2 == 0
    weighing = Weighing(lines, superset.arm.tolerances, Discrepancy(), on_base=on_base)
    own = weighing.prior[:, [0, 1, 2], [0, 1, 2]]
    assert (own[on_base] >= BASE_GAIN_STD).all()
    assert (own[~on_base] < 0.1 * BASE_GAIN_STD).all()


def test_on_a_wide_shell_points_stand_before_an_axis_by_where_they_are_along_the_link(superset):
    """A point beside the link's foot is further from its joint than one a little way up."""
    link = 1
    root, tip = span_m(superset, link)
    along = (tip - root) / np.linalg.norm(tip - root)
    beside = np.cross(along, [0.0, 0.0, 1.0])
    beside /= np.linalg.norm(beside)
    own = [
        p.id for p, at in zip(superset.arm.points, superset.point_link, strict=True) if at == link
    ]
    foot, above, *_ = own
    places = {foot: 0.02 * along + 0.15 * beside, above: 0.1 * along}
    points = [
        replace(p, position_m=places.get(p.id, p.position_m + along)) for p in superset.arm.points
    ]
    ordinary = Ordinary(
        superset=Superset(replace(superset.arm, points=tuple(points))), postures=("p",)
    )
    offered = splits(ordinary, link)
    assert {(foot,), (above,), (foot, above)} <= set(offered)
    assert len(set(offered)) == len(offered)
