"""Spaces, verdicts and arm-file entries of the gap workflow."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.judge import (
    is_plainer,
    judge,
    one_mechanism,
)
from armodal.analyzer.gap.decision.naming import judge_round
from armodal.analyzer.gap.effects import (
    absorber,
    base,
    bearing,
    coupling,
    encoder_offset,
    friction,
    gravity_compensator,
    hysteretic,
    link_axis,
    link_bending,
    link_torsion,
    nonproportional,
    released_joint,
    sensor_axes,
    wrist_coupling,
)
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.long_links import long_links
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.search.rivals import Rivals
from armodal.protocols.arm.files import load_arm


def test_vectors_count_deviations_and_keep_to_bounds():
    space = Space(
        [
            Parameter(name="a", unit="", mean=1.0, std=0.5),
            Parameter(name="b", unit="", mean=0.0, std=2.0, low=0.0, start=4.0),
        ]
    )
    np.testing.assert_allclose(space.start(), [0.0, 2.0])
    np.testing.assert_allclose(space.start({"b": -3.0}), [0.0, 0.0])
    assert space.values(np.array([2.0, 0.5])) == {"a": 2.0, "b": 1.0}


def test_effects_have_words_for_people():
    for words in (link_axis.WORDS, bearing.WORDS):
        assert words.title
        assert words.told_by
        assert words.remedy


def standing_at(words, place):
    return Instance(effect=words, place=place)


def test_a_coupling_and_a_compensator_at_one_joint_are_one_mechanism_nobody_listed():
    pair = standing_at(coupling.WORDS, "a and b")
    beside = standing_at(gravity_compensator.WORDS, "b")
    elsewhere = standing_at(gravity_compensator.WORDS, "c")
    assert one_mechanism([pair, beside], JOINTS) == (pair, beside)
    assert one_mechanism([beside, pair], JOINTS) == (pair, beside)
    assert one_mechanism([pair, elsewhere], JOINTS) is None
    assert one_mechanism([pair, standing_at(bearing.WORDS, "b")], JOINTS) is None


def test_an_axis_in_a_link_and_a_slip_at_one_of_its_joints_are_a_crack_nobody_listed():
    axis = standing_at(link_axis.WORDS, "l1")
    for joint, told in (("j0", False), ("j1", True), ("j2", True)):
        slip = standing_at(friction.WORDS, joint)
        assert one_mechanism([axis, slip], JOINTS) == ((axis, slip) if told else None)
        assert one_mechanism([slip, axis], JOINTS) == ((axis, slip) if told else None)


def test_two_masses_that_swing_are_one_that_swings_more_ways_than_one():
    here, far = (standing_at(absorber.WORDS, link) for link in ("l0", "l2"))
    assert one_mechanism([here, far], JOINTS) == (here, far)
    assert one_mechanism([here, standing_at(bearing.WORDS, "j0")], JOINTS) is None


def test_an_effect_beyond_the_most_that_are_looked_for_is_not_what_the_verdict_rests_on():
    """Else what it explains would count as explained, and nobody would be told."""
    notes = []
    present, better = rival(link_axis.WORDS, "l1", 1e4), rival(bearing.WORDS, "j0", 5e3)
    stage = SimpleNamespace(weighings=[SimpleNamespace(n=40000)], lines=())
    found = Rivals(present=present, rivals=(better,))

    assert judge_round(stage, found, LIMITS, 2, 3, notes).named is better
    assert notes == []
    for n_named, rounds in ((3, 4), (2, 6)):
        last = judge_round(stage, found, LIMITS, n_named, rounds, notes)
        assert (last.named, last.standing) == (None, ())
        assert notes.pop() == f"{bearing.WORDS.title} (j0) is clear too, but the search stops here"


def test_a_loss_below_the_ordinary_one_is_no_hysteretic_damping():
    """Its prior's wide damping may fit better; the loss itself is what the name says."""
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    (instance,) = hysteretic.instances(ordinary)
    none = dict.fromkeys(instance.sizes, 0.0)
    assert not instance.is_material(none)
    assert not instance.is_material({**none, instance.sizes[0]: 0.9 * instance.size_offset})
    assert instance.is_material({**none, instance.sizes[-1]: 3.0 * instance.size_offset})


def test_a_base_that_turns_about_the_vertical_alone_is_worth_a_name():
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    (instance,) = base.instances(ordinary)
    nothing = dict.fromkeys(instance.owned, 0.0)
    turns = next(name for name in instance.owned if name.endswith("rock z"))
    assert not instance.is_material(nothing)
    assert instance.is_material({**nothing, turns: 2.0 * instance.material})


def test_the_level_lines_a_base_rocks_about_are_told():
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    (instance,) = base.instances(ordinary)
    (turn,) = (name for name in instance.owned if name.endswith("turn"))
    told = instance.describe({turn: np.pi / 6.0})
    # Cosine and sine of 30 degrees; the other line is across.
    assert told["rock_x_about"] == pytest.approx([np.sqrt(0.75), 0.5, 0.0])
    assert told["rock_y_about"] == pytest.approx([-0.5, np.sqrt(0.75), 0.0])


# With data that weigh a tenth, the prior is the steeper: the density has its peak inside.
@pytest.mark.parametrize("inflation", [1.0, 10.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_parameter_at_its_bound_has_a_one_sided_interval(side, inflation):
    """95 % of the draws of such a density lie inside, another parameter free beside it."""
    rng = np.random.default_rng(5)
    H = np.array([[9.0, 4.0], [4.0, 5.0]])
    low, high = (0.0, np.inf) if side > 0.0 else (-np.inf, 0.0)
    priors = (
        Parameter(name="size", unit="kg", mean=side * 0.6, std=2.0, low=low, high=high),
        Parameter(name="other", unit="", mean=0.0, std=1.0),
    )
    bound = np.array([-side * 0.3, 0.0])
    fit = replace(
        made_fit(Hypothesis(ordinary=None), cost=0.0, space=Space(priors), u=bound),
        curvature=H - np.eye(2),  # the prior adds its own
        slope=np.array([side * 1.5, 0.0]),
        free=np.array([False, True]),
    )
    found = intervals(fit, ["size"], inflation)["size"]
    far = np.sqrt(inflation)
    u = far * rng.uniform([0.0, -4.0], [3.0, 4.0], (1_000_000, 2)) * [side, 1.0]
    data = (1.5 + 0.3) * np.abs(u[:, 0]) + 0.5 * np.einsum("ni,ij,nj->n", u, H - np.eye(2), u)
    prior = 0.5 * np.sum((bound + u) ** 2 - bound**2, axis=1)
    cost = data / inflation + prior
    drawn = 2.0 * u[rng.random(len(u)) < np.exp(-(cost - cost.min())), 0]
    inside = np.mean((drawn >= found.low) & (drawn <= found.high))
    # Of n draws the rate has a deviation of sqrt(0.05 * 0.95 / n): four of them.
    assert abs(inside - 0.95) < 4.0 * np.sqrt(0.05 * 0.95 / drawn.size)
    assert drawn.size > 5_000
    assert found.value == 0.0
    assert min(abs(found.low), abs(found.high)) == 0.0


def rival(words, place, cost):
    """A fit with a material effect at a place of an arm of two joints; its evidence is its cost."""
    size = Parameter(name="size", unit="", mean=0.0, std=1.0)
    arm = SimpleNamespace(joints=JOINTS)
    ordinary = SimpleNamespace(arm=arm, level_span=0.0, levels_hit=True)
    instance = Instance(effect=words, place=place, parameters=(size,), size="size", material=0.1)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    return made_fit(hypothesis, cost=cost, space=Space([size]), u=[1.0], resting=["size"])


JOINTS = [
    SimpleNamespace(name=f"j{i}", link=SimpleNamespace(name=f"l{i}"), axis=(0.0, 0.0, 1.0))
    for i in range(3)
]
# A hundred nats for any effect, rivals 20 apart: errors four times as large as independent ones.
LIMITS = made_calibration()
OF_1000 = SimpleNamespace(weighings=[SimpleNamespace(n=1000)], lines=())


def test_what_stands_is_among_the_rivals_though_no_search_led_to_it():
    best, found, twin = (
        rival(words, "j1", cost)
        for words, cost in ((coupling.WORDS, 10.0), (friction.WORDS, 30.0), (bearing.WORDS, 20.0))
    )
    present = made_fit(Hypothesis(ordinary=best.hypothesis.ordinary, instances=()), cost=90.0)
    rivals = Rivals(present=present, rivals=(best, found))
    assert rivals.with_standing((best, twin, present)) == (best, twin, found)
    assert rivals.with_standing(()) == (best, found)


def axis(cost):
    return rival(link_axis.WORDS, "l1", cost)


@pytest.mark.parametrize(("better", "stands"), [(10.0, False), (300.0, True)])
def test_what_holds_the_best_inside_it_stands_beside_it_where_that_is_told(better, stands):
    """Though it takes off most of the misfit: that is what it holds inside."""
    inside = rival(released_joint.WORDS, "j2", 1000.0)
    around = rival(wrist_coupling.WORDS, "j1 and j2", 1000.0 - better)
    small = replace(around, u=np.array([0.05]))  # a turn back that is too small to matter
    found = judge(OF_1000, rival(coupling.WORDS, "before", 2000.0), (small, inside), LIMITS)
    assert (found.named is None) == stands
    assert (small in found.standing) == stands


@pytest.mark.parametrize(("std", "is_named"), [(0.3, True), (0.5, False)])
def test_a_name_is_told_to_be_large_enough(std, is_named):
    """One, where a tenth is material: 0.41 or more, or 0.02."""
    told = rival(bearing.WORDS, "j1", 1000.0)
    curvature = np.array([[std**-2 - 1.0]]) * LIMITS.inflation  # the prior's is counted besides
    told = replace(told, free=np.array([True]), curvature=curvature)
    present = rival(coupling.WORDS, "before", 1900.0)
    assert (judge(OF_1000, present, [told], LIMITS).named is told) == is_named


@pytest.mark.parametrize(("left", "is_named"), [(0.4, True), (0.6, False)])
def test_what_is_small_is_named_where_it_explains_most_of_what_is_missing(left, is_named):
    """A damper at a long lever: small as a damper, and half of all that the model leaves."""
    small = replace(rival(nonproportional.WORDS, "l1", left * 2000.0), u=np.array([0.05]))
    assert not small.last.is_material(small.values)
    present = rival(coupling.WORDS, "before", 2000.0)
    assert (judge(OF_1000, present, [small], LIMITS).named is small) == is_named
    # Something large that is clear too, but far behind, takes no name from it and none beside it.
    large = rival(bearing.WORDS, "j1", 1500.0)
    assert (judge(OF_1000, present, [small, large], LIMITS).named is small) == is_named
    assert judge(OF_1000, present, [small, large], LIMITS).named is not large


@pytest.mark.parametrize(("behind", "is_joint"), [(50.0, True), (150.0, False)])
def test_a_joint_believed_rigid_is_the_name_only_where_an_axis_on_it_explains_little_more(
    behind, is_joint
):
    line = with_changed(axis(ORDINARY.evidence - 1000.0), is_also=lambda *_: True)
    joint = rival(released_joint.WORDS, "j1", line.evidence + behind)
    assert is_plainer(joint, line, ORDINARY) == is_joint
    assert not is_plainer(joint, with_changed(line, is_also=lambda *_: False), ORDINARY)


def test_of_one_effect_at_two_places_that_are_alike_the_better_has_the_name():
    line = with_changed(axis(ORDINARY.evidence - 1000.0), is_also=lambda *_: True)
    assert not is_plainer(axis(line.evidence + 50.0), line, ORDINARY)


def with_changed(fit, **changes):
    """A fit whose only effect is changed."""
    (instance,) = fit.hypothesis.instances
    return replace(
        fit, hypothesis=replace(fit.hypothesis, instances=(replace(instance, **changes),))
    )


def sensor_fault(place, cost):
    """Axes exchanged or turned round: nothing to tune."""
    return with_changed(rival(sensor_axes.FLIPPED, place, cost), parameters=(), size="")


def beyond_tolerance(place, cost):
    """An ordinary parameter with a wider prior, and no new term."""
    fit = rival(encoder_offset.WORDS, place, cost)
    (size,) = fit.space.parameters
    return with_changed(fit, parameters=(), relaxes={"size": replace(size, std=10.0)})


ORDINARY = rival(coupling.WORDS, "before", 290.0)


@pytest.mark.parametrize(
    ("made", "gain", "is_named"),
    [
        (partial(rival, bearing.WORDS), 39.0, False),
        (partial(rival, bearing.WORDS), 41.0, True),
        (beyond_tolerance, 6.0, False),
        (beyond_tolerance, 8.0, True),
        (sensor_fault, 99.0, False),  # no linear look tells of it: the limit of the whole library
        (sensor_fault, 101.0, True),
    ],
)
def test_each_kind_of_effect_has_the_limit_that_replicas_gave_it(made, gain, is_named):
    limits = made_calibration(apart=5.0, limits={"bearing": 40.0, "encoder_offset": 7.0})
    only = made("j1", ORDINARY.evidence - gain)
    assert (judge(OF_1000, ORDINARY, [only], limits).named is only) == is_named


@pytest.mark.parametrize(("behind", "stands"), [(10.0, True), (30.0, False)])
def test_a_rival_stands_beside_the_best_until_it_is_well_behind(behind, stands):
    best = rival(bearing.WORDS, "j0", 100.0)
    other = rival(gravity_compensator.WORDS, "j2", 100.0 + behind)
    found = judge(OF_1000, ORDINARY, [best, other], LIMITS)
    assert found.named is (None if stands else best)
    assert found.standing == ((best, other) if stands else (best,))


def test_a_joint_has_its_name_though_an_axis_on_it_is_ahead_by_more_than_tells_rivals_apart():
    line = with_changed(axis(100.0), is_also=lambda _values, other: other.place == "j1")
    joint = rival(released_joint.WORDS, "j1", 180.0)
    present = rival(coupling.WORDS, "before", 2000.0)
    assert LIMITS.apart < 80.0 < 0.1 * 1900.0
    assert judge(OF_1000, present, [line, joint], LIMITS).named is joint


@pytest.mark.parametrize("is_joint", [True, False])
def test_what_is_another_thing_told_better_stands_no_longer(is_joint):
    line = with_changed(
        axis(100.0), is_also=lambda _values, other: is_joint and other.place == "j1"
    )
    joint = rival(released_joint.WORDS, "j1", 105.0)
    found = judge(OF_1000, ORDINARY, [line, joint], LIMITS)
    assert found.named is (joint if is_joint else None)
    assert found.standing == ((joint,) if is_joint else (line, joint))


@pytest.mark.parametrize(
    ("link", "degrees", "off_m", "is_joint"),
    [(1, 10.0, 0.02, True), (1, 12.0, 0.0, False), (1, 0.0, 0.04, False), (2, 0.0, 0.0, False)],
)
def test_an_axis_is_the_released_joint_only_where_it_lies_on_it(link, degrees, off_m, is_joint):
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    joint = ordinary.arm.joints[1]
    own = np.asarray(joint.axis)
    aside, beside = across(own).T
    tilt = np.deg2rad(degrees)
    line = link_axis.at_axis(
        ordinary,
        link,
        np.cos(tilt) * own + np.sin(tilt) * aside,
        off_m * beside,
    )
    values = {p.name: p.first for p in line.parameters}
    released = Instance(effect=released_joint.WORDS, place=joint.name)
    assert line.is_also(values, released) is is_joint
    assert not line.is_also(values, Instance(effect=bearing.WORDS, place=joint.name))


@pytest.mark.parametrize(
    ("degrees", "off_m", "twists"), [(10.0, 0.02, True), (12.0, 0.0, False), (0.0, 0.04, False)]
)
def test_an_axis_is_a_twist_only_where_it_lies_along_its_long_link(degrees, off_m, twists):
    """At one place of the tube or spread over it: the same motion beyond."""
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    tube, other = long_links(ordinary.superset)[:2]
    aside, beside = across(tube.along).T
    tilt = np.deg2rad(degrees)
    direction = np.cos(tilt) * tube.along + np.sin(tilt) * aside
    line = link_axis.at_axis(ordinary, tube.link, direction, tube.start_m + off_m * beside)
    values = {p.name: p.first for p in line.parameters}
    assert line.is_also(values, Instance(effect=link_torsion.WORDS, place=tube.name)) is twists
    assert not line.is_also(values, Instance(effect=link_torsion.WORDS, place=other.name))
    assert not line.is_also(values, Instance(effect=link_bending.WORDS, place=tube.name))


@pytest.mark.parametrize(
    ("out_of_plane", "off_m", "couples"),
    [(10.0, 0.02, True), (13.0, 0.0, False), (0.0, 0.04, False)],
)
def test_an_axis_that_turns_about_two_joints_where_they_meet_is_their_coupling(
    out_of_plane, off_m, couples
):
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    joint, beyond = ordinary.arm.joints[4:6]
    T = beyond.T_parent_joint
    first, second, offset = np.asarray(joint.axis), T[:3, :3] @ beyond.axis, T[:3, 3]
    # The wrist's last two axes meet: somewhere along the first the second's line is reached.
    along = np.linalg.lstsq(np.stack([first, -second], axis=1), offset, rcond=None)[0]
    meeting = along[0] * first
    assert meeting == pytest.approx(offset + along[1] * second, abs=1e-9)
    normal, both = (v / np.linalg.norm(v) for v in (np.cross(first, second), first + second))
    tilt = np.deg2rad(out_of_plane)
    direction, aside = np.cos(tilt) * both + np.sin(tilt) * normal, np.cross(normal, both)
    line = link_axis.at_axis(ordinary, 4, direction, meeting + off_m * aside)
    values = {p.name: p.first for p in line.parameters}
    of_both = Instance(effect=coupling.WORDS, place=f"{joint.name} and {beyond.name}")
    assert line.is_also(values, of_both) is couples
    other = Instance(effect=coupling.WORDS, place=f"{ordinary.arm.joints[3].name} and {joint.name}")
    assert not line.is_also(values, other)
