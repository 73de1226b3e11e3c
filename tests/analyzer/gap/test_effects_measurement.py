"""Windows, directions and places of a measurement beside independent ways to the same FRFs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.bench_effects import JOINTS

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.effects import (
    exponential_window,
    hit_direction,
    sensor_candidates,
    wrong_point,
)
from armodal.analyzer.gap.effects.point_candidates import channel_candidates
from armodal.analyzer.gap.effects.sensor_axes import turned_sensor
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter


@pytest.fixture(scope="module")
def lines(lines):
    return replace(lines, variance=np.full_like(lines.variance, 1e-12), sensor_mass_kg=0.0)


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p",))


@pytest.fixture(scope="module")
def posed(superset):
    return PosedModel(superset, JOINTS)


def predicted(posed, ordinary, lines, instances=(), **changes):
    hypothesis = Hypothesis(ordinary=ordinary, instances=instances)
    space = hypothesis.space()
    values = space.values(space.start()) | changes
    return posed.values(hypothesis, lines, values)


def test_a_window_nobody_took_off_is_the_frf_further_from_the_poles(posed, ordinary, lines):
    """Force and response times e^(-d t): H(s + d)."""
    window = exponential_window.instances(ordinary)
    d = 2.4
    further = replace(lines, s_rad_s=lines.s_rad_s + d)
    np.testing.assert_allclose(
        predicted(posed, ordinary, lines, window, **{window[0].size: d}),
        predicted(posed, ordinary, further),
        rtol=1e-12,
    )


def test_turned_hits_are_hits_along_the_turned_direction(posed, ordinary, lines):
    turn = hit_direction.instances(ordinary)[:1]
    vector = np.array([0.1, -0.05, 0.2])
    turned = lines.hit_direction @ Rotation.from_rotvec(vector).as_matrix().T
    np.testing.assert_allclose(
        predicted(
            posed, ordinary, lines, turn, **dict(zip(turn[0].sizes, vector.tolist(), strict=True))
        ),
        predicted(posed, ordinary, replace(lines, hit_direction=turned)),
        rtol=1e-12,
    )


def test_where_the_hammer_roves_the_hits_of_one_posture_may_be_turned(posed, ordinary, lines):
    """As a common turn does there, and nothing elsewhere."""
    ordinary = replace(ordinary, postures=("p", "another posture"))
    common, here, _ = hit_direction.instances(ordinary)
    by = (0.1, -0.05, 0.2)
    turned = [
        predicted(posed, ordinary, lines, (own,), **dict(zip(own.sizes, by, strict=True)))
        for own in (common, here)
    ]
    np.testing.assert_array_equal(*turned)
    other = replace(lines, name="another posture")
    np.testing.assert_array_equal(
        predicted(posed, ordinary, other, (here,), **dict(zip(here.sizes, by, strict=True))),
        predicted(posed, ordinary, other),
    )
    alone = replace(ordinary, one_is_hit=True)
    assert [bool(own.relaxes) for own in hit_direction.instances(alone)] == [False, True, True]


def test_exchanged_points_are_recorded_under_each_other_s_name(posed, ordinary, lines):
    y = predicted(posed, ordinary, lines)
    got = predicted(posed, ordinary, lines, (wrong_point.exchanged(ordinary, "k2", "l1"),))
    a, b = (ordinary.superset.point_index[p] for p in ("k2", "l1"))
    order = np.arange(len(y))
    order[[a, b]] = b, a
    np.testing.assert_allclose(got, y[order], rtol=1e-12)


def test_a_point_was_another_in_one_posture_only(posed, ordinary, lines):
    y = predicted(posed, ordinary, lines)
    here = (wrong_point.stood_at(ordinary, "k2", "l1", "p"),)
    elsewhere = (wrong_point.stood_at(ordinary, "k2", "l1", "another"),)
    a, b = (ordinary.superset.point_index[p] for p in ("k2", "l1"))
    np.testing.assert_allclose(predicted(posed, ordinary, lines, here)[a], y[b], rtol=1e-12)
    np.testing.assert_allclose(predicted(posed, ordinary, lines, elsewhere), y, rtol=1e-12)


def test_a_shifted_point_is_one_that_the_arm_file_has_there(ordinary, lines, posed):
    """The arm file with the point moved, without the effect."""
    by = np.array([0.03, -0.02, 0.05])
    at = ordinary.superset.point_index["k2"]
    points = list(ordinary.arm.points)
    points[at] = replace(points[at], position_m=points[at].position_m + by)
    moved = Superset(replace(ordinary.arm, points=tuple(points)))
    shifted = wrong_point.beside(ordinary, "k2")
    np.testing.assert_allclose(
        predicted(
            posed, ordinary, lines, (shifted,), **dict(zip(shifted.sizes, by.tolist(), strict=True))
        ),
        predicted(PosedModel(moved, JOINTS), Ordinary(superset=moved, postures=("p",)), lines),
        rtol=1e-9,
    )


@pytest.fixture
def of_hammer(ordinary, lines):
    """The hammer goes from point to point, each hit along a direction of its own."""
    n = len(ordinary.arm.points)
    along = np.random.default_rng(3).standard_normal((n, 3))
    return replace(
        lines,
        sensor_point=np.zeros(n, dtype=int),
        hit=np.arange(n),
        hit_point=np.arange(n),
        hit_direction=along / np.linalg.norm(along, axis=1, keepdims=True),
    )


@pytest.mark.parametrize("kept", [False, True])
def test_hits_at_exchanged_points_are_hits_at_the_other(kept, posed, ordinary, of_hammer):
    a, b = (ordinary.superset.point_index[p] for p in ("k2", "l1"))
    order = np.arange(len(of_hammer.hit))
    order[[a, b]] = b, a
    along = of_hammer.hit_direction if kept else of_hammer.hit_direction[order]
    truly = replace(of_hammer, hit_point=order, hit_direction=along)
    made = wrong_point.exchanged(ordinary, "k2", "l1", kept=kept)
    np.testing.assert_allclose(
        predicted(posed, ordinary, of_hammer, (made,)),
        predicted(posed, ordinary, truly),
        rtol=1e-12,
    )


@pytest.mark.parametrize("kept", [False, True])
def test_the_scan_finds_points_that_the_hammer_exchanged(kept, ordinary, of_hammer, posed):
    made = wrong_point.exchanged(ordinary, "k2", "l1", kept=kept)
    found = looked_at(ordinary, of_hammer, posed, made).instance
    assert found.key == made.key
    assert found.describe({}) == made.describe({})


@pytest.mark.parametrize(("roves", "kept"), [("hammer", False), ("hammer", True), ("sensor", True)])
def test_the_scan_finds_a_point_exchanged_for_what_stays_too(
    roves, kept, ordinary, lines, of_hammer, posed
):
    """Whoever mixes up two labels has the sensor and the hammer at the wrong one."""
    own = of_hammer if roves == "hammer" else lines
    first = ordinary.arm.points[own.still_point[0]].id
    made = wrong_point.exchanged(ordinary, first, "l1", kept=kept, still=True)
    assert set(own.still_point.tolist()) == {ordinary.superset.point_index[first]}
    a, b = (ordinary.superset.point_index[p] for p in (first, "l1"))
    order = np.arange(len(ordinary.arm.points))
    order[[a, b]] = b, a
    along = own.hit_direction if kept else own.hit_direction[order]
    truly = replace(
        own,
        sensor_point=order[own.sensor_point],
        hit_point=order[own.hit_point],
        hit_direction=along,
    )
    np.testing.assert_allclose(
        predicted(posed, ordinary, own, (made,)), predicted(posed, ordinary, truly), rtol=1e-12
    )
    found = looked_at(ordinary, own, posed, made).instance
    assert found.key == made.key
    read = wrong_point.of_file(ordinary, found.describe({}))
    assert (read.key, read.describe({})) == (made.key, found.describe({}))


def test_the_scan_finds_where_the_hammer_fell_beside_its_point(ordinary, of_hammer, posed):
    made = wrong_point.beside(ordinary, "k2")
    by = dict(zip(made.sizes, (0.02, -0.01, 0.03), strict=True))
    found = looked_at(ordinary, of_hammer, posed, made, **by)
    assert found.instance.key == made.key
    for name, wanted in by.items():
        # A hit's place along its own direction does nothing: the prior holds it.
        assert abs(found.begin[name]) <= abs(wanted) + 3e-3


def test_at_a_sensor_that_stays_a_fault_is_told_once(ordinary, of_hammer, posed):
    """Of the sensor, not also of the one point where it stands."""
    flip = turned_sensor(ordinary, np.diag([-1.0, 1.0, 1.0]), None)
    data = replace(of_hammer, values=predicted(posed, ordinary, of_hammer, (flip,)))
    stage = Stage(ordinary.superset, [data], Discrepancy(), models=[posed])
    null = Hypothesis(ordinary=ordinary)
    space = null.space()
    found = sensor_candidates.channel_candidates(stage, null, space.values(space.start()))
    assert found[0].instance.key == flip.key
    assert [c.instance.place for c in found if c.instance.place.startswith("point ")] == []


@pytest.mark.parametrize(
    "make",
    [
        lambda o: exponential_window.instances(o)[0],
        lambda o: hit_direction.instances(o)[0],
        lambda o: wrong_point.beside(o, "k2"),
        lambda o: wrong_point.beside(o, o.arm.points[0].id),  # the hammer's point moves too
    ],
)
def test_derivatives_are_those_of_differences(make, ordinary, lines, posed):
    instance = make(ordinary)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    space = hypothesis.space()
    u = space.start()
    own = [space.index[name] for name in instance.owned]
    u[own] += 0.3
    _, dy = posed.derivatives(hypothesis, lines, space, space.values(u))
    for i in own:
        ends = []
        for side in (1e-4, -1e-4):
            moved = u.copy()
            moved[i] += side
            ends.append(posed.values(hypothesis, lines, space.values(moved)))
        want = (ends[0] - ends[1]) / 2e-4
        # One-sided differences over a thousandth of the prior inside: 1e-3 of a curved column.
        np.testing.assert_allclose(dy[i], want, atol=3e-3 * np.abs(want).max())


def test_derivatives_by_the_hits_place_are_those_where_it_truly_struck(ordinary, lines, posed):
    """What stayed stood at another point, whose axes are others."""
    first, other = ordinary.arm.points[int(lines.hit_point[0])].id, "k2"
    ordinary = replace(ordinary, hit_points=(first,))
    still = wrong_point.exchanged(ordinary, first, other, still=True)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(still,))
    space = hypothesis.space()
    values = space.values(space.start())
    _, dy = posed.derivatives(hypothesis, lines, space, values)
    for name in ordinary.hit_place_names(first):
        step = 1e-3 * space.std[space.index[name]]
        ends = (posed.values(hypothesis, lines, values | {name: x}) for x in (step, -step))
        want = np.subtract(*ends) / 2e-3
        np.testing.assert_allclose(dy[space.index[name]], want, atol=1e-6 * np.abs(want).max())


def looked_at(ordinary, lines, posed, instance, **changes):
    """The scan's first candidate on data that the instance makes."""
    data = replace(lines, values=predicted(posed, ordinary, lines, (instance,), **changes))
    stage = Stage(ordinary.superset, [data], Discrepancy(), models=[posed])
    space = Hypothesis(ordinary=ordinary).space()
    return channel_candidates(stage, Hypothesis(ordinary=ordinary), space.values(space.start()))[0]


def test_the_scan_finds_exchanged_points(ordinary, lines, posed):
    made = wrong_point.exchanged(ordinary, "k2", "l1")
    found = looked_at(ordinary, lines, posed, made)
    assert found.instance.effect.name == "wrong_point"
    assert {"k2", "l1"} <= set(found.instance.place.split())


def test_the_scan_finds_a_shifted_point_and_where_it_is(ordinary, lines, posed):
    made = wrong_point.beside(ordinary, "k2")
    by = dict(zip(made.sizes, (0.02, -0.01, 0.03), strict=True))
    found = looked_at(ordinary, lines, posed, made, **by)
    assert found.instance.key == made.key
    for name, wanted in by.items():
        # Linear but for the accelerometer's mass, which is zero here; mounting errors and the
        # prior of 0.1 m take a little of it.
        assert found.begin[name] == pytest.approx(wanted, abs=3e-3)


@pytest.mark.parametrize(
    "make",
    [
        lambda o: exponential_window.instances(o)[0],
        lambda o: hit_direction.instances(o)[0],
        lambda o: wrong_point.beside(o, "k2"),
        lambda o: wrong_point.exchanged(o, "k2", "l1"),
        lambda o: wrong_point.exchanged(o, "k2", "l1", kept=True),
        lambda o: wrong_point.exchanged(o, "k2", "l1", still=True),
        lambda o: wrong_point.stood_at(o, "k2", "l1", "p"),
    ],
)
def test_named_in_an_arm_file_it_comes_back(make, ordinary, superset):
    instance = make(ordinary)
    values = {name: 0.01 * (i + 1) for i, name in enumerate(instance.owned)}
    description = {} if instance.describe is None else instance.describe(values)
    effect = AddedEffect(
        name=instance.effect.name,
        place=instance.place or "whole arm",
        parameters=tuple(
            EffectParameter(
                name=file_key(n, instance.place), unit="", value=v, std=0.0, low=v, high=v
            )
            for n, v in values.items()
        ),
        description={k: tuple(v) if isinstance(v, list) else v for k, v in description.items()},
        evidence=EffectEvidence(
            gain_nats=50.0,
            held_out_gain_nats=10.0,
            confidence=1.0,
            session_sha256="0" * 64,
            created="2026-01-31T12:00:00+00:00",
        ),
    )
    arm = replace(superset.arm, effects=(effect,))
    (back,), start = instances_of_file(Ordinary(superset=Superset(arm), postures=ordinary.postures))
    assert back.key == instance.key
    assert start == pytest.approx(values)
