"""Where a long link gives way, and about which directions, beside closed forms."""

from itertools import product

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import link_axis, link_torsion
from armodal.analyzer.gap.effects.hinges import hinges_along, soft_places
from armodal.analyzer.gap.effects.yielding_line import YieldingLine
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.long_links import LongLink, long_links
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm

LINE = LongLink(
    link=0,
    name="l",
    along=np.array([0.6, 0.0, 0.8]),
    length_m=0.4,
    start_m=np.array([0.1, -0.05, 0.02]),
)


def line_of(bends):
    return YieldingLine(line=LINE, bends=bends, word="w")


def values_of(yielding, **told):
    """Of its parameters, none where nothing is told."""
    return {p.name: told.get("_".join(p.name.split()[1:-1]), 0.0) for p in yielding.parameters}


def yields_of(yielding, **shape):
    """(2, 2) of one place, about both directions across."""
    values, beside = values_of(yielding, **shape), across(LINE.along)
    shares, _ = yielding.shares(values)
    u = np.stack([yielding.hinge(values, 0.1, i)[0][3:] for i in range(yielding.n_hinges)]) @ beside
    return (u.T * shares) @ u


def test_a_round_casting_yields_alike_about_all_directions_across():
    np.testing.assert_allclose(yields_of(line_of(True)), np.eye(2), atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 6, 1.3, 2.5])
@pytest.mark.parametrize("ratio", [1.1, 3.0, 20.0])
def test_a_flat_casting_is_softer_about_any_direction_by_any_ratio(angle, ratio):
    """By the factor of Cholesky of what is wanted; the mean yield stays one."""
    bends = line_of(True)
    soft = np.array([np.cos(angle), np.sin(angle)])
    wanted = np.eye(2) + (ratio - 1.0) * np.outer(soft, soft)
    wanted *= 2.0 / np.trace(wanted)
    lean = wanted[0, 1] / wanted[1, 1]
    first = wanted[0, 0] - lean**2 * wanted[1, 1]
    shape = {"lean": lean, "flat": np.log(first / wanted[1, 1])}
    np.testing.assert_allclose(yields_of(bends, **shape), wanted, atol=1e-12)
    directions, yields = bends.softest(values_of(bends, **shape))
    assert yields[0] / yields[1] == pytest.approx(ratio)
    assert abs(directions[:, 0] @ across(LINE.along) @ soft) == pytest.approx(1.0)


def test_parts_of_a_yield_follow_by_their_slopes():
    """Central differences of 1e-6: rounding leaves 1e-10."""
    bends = line_of(True)
    values, step = values_of(bends, flat=0.8, lean=-0.4), 1e-6
    _, slopes = bends.shares(values)
    for name, slope in zip(bends.sharing, slopes, strict=True):
        more, less = (bends.shares(values | {name: values[name] + d})[0] for d in (step, -step))
        np.testing.assert_allclose((more - less) / (2 * step), slope, atol=1e-9)


@pytest.mark.parametrize("bends", [True, False])
def test_a_line_that_lies_elsewhere_has_its_hinges_there(bends):
    """To first order in the turn: the second is below half its square."""
    moved = line_of(bends)
    told = {"aside_a": 0.02, "aside_b": -0.03, "turn_a": 0.01, "turn_b": -0.02}
    start, end = moved.ends(values_of(moved, **told))
    along = (end - start) / LINE.length_m
    assert np.linalg.norm(along) == pytest.approx(1.0)
    for way in range(moved.n_hinges):
        for s in LINE.places_m:
            twist, *_ = moved.hinge(values_of(moved, **told), s, way)
            u, place = twist[3:], start + s * along
            if not bends:
                np.testing.assert_allclose(u, along, atol=5e-4)
            else:
                assert abs(u @ along) < 5e-4
            np.testing.assert_allclose(twist[:3], np.cross(place, u), atol=5e-4)


@pytest.mark.parametrize("bends", [True, False])
def test_a_line_that_bows_has_its_hinges_along_a_parabola(bends):
    """Each across the tangent, or along it, and as long as on a straight line."""
    bowed = line_of(bends)
    values = values_of(bowed, bow_a=0.06, bow_b=-0.08)
    start, end = bowed.ends(values)
    np.testing.assert_allclose(start, LINE.start_m)
    np.testing.assert_allclose(end, LINE.start_m + LINE.length_m * LINE.along)
    bow_m = bowed.bow_m(values)
    assert np.linalg.norm(bow_m) == pytest.approx(0.1 * LINE.length_m)
    for way in range(bowed.n_hinges):
        for s in (0.0, *LINE.places_m, LINE.length_m):
            part = s / LINE.length_m
            place = start + part * (end - start) + 4.0 * part * (1.0 - part) * bow_m
            tangent = LINE.along + 4.0 * (1.0 - 2.0 * part) * bow_m / LINE.length_m
            twist, *_ = bowed.hinge(values, s, way)
            if bends:
                assert abs(twist[3:] @ tangent) < 1e-12
            else:
                np.testing.assert_allclose(twist[3:], tangent / np.linalg.norm(tangent), atol=1e-12)
            assert np.linalg.norm(twist[3:]) == pytest.approx(1.0)
            np.testing.assert_allclose(twist[:3], np.cross(place, twist[3:]), atol=1e-12)


@pytest.mark.parametrize("bends", [True, False])
def test_hinges_follow_the_line_by_their_slopes(bends):
    """Central differences of 1e-6: products of two parameters leave 1e-12."""
    moved = line_of(bends)
    told = {"aside_a": 0.02, "aside_b": -0.03, "turn_a": 0.1, "turn_b": -0.2, "lean": 0.3}
    told |= {"bow_a": 0.08, "bow_b": -0.05}
    values, s, step = values_of(moved, **told), LINE.places_m[1], 1e-6
    for way in range(moved.n_hinges):
        _, slopes, by_s = moved.hinge(values, s, way)
        beyond, before = (moved.hinge(values, s + d, way)[0] for d in (step, -step))
        np.testing.assert_allclose((beyond - before) / (2 * step), by_s, atol=1e-8)
        for name, slope in zip(moved.moving, slopes, strict=True):
            more, less = (
                moved.hinge(values | {name: values[name] + d}, s, way)[0] for d in (step, -step)
            )
            np.testing.assert_allclose((more - less) / (2 * step), slope, atol=1e-8)


def test_hinges_are_made_anew_where_a_value_of_theirs_changes():
    superset = Superset(load_arm("rv4frl"))
    bends = YieldingLine(line=long_links(superset)[0], bends=True, word="w")
    where = ("place", "stretch", "taper", "middle")
    values = values_of(bends) | {"place": 0.4, "stretch": 0.6, "taper": 0.0, "middle": 0.0}
    hinges = hinges_along(superset, bends, where)
    first = hinges(values)
    assert hinges(values | {"of another": 1.0}) is first
    # They yield for the link's length about each of two directions across.
    assert sum(h.part_m for h in first) == pytest.approx(2.0 * bends.line.length_m)
    for name in values:
        other, again = (hinges(values | {name: 0.1}) for _ in range(2))
        assert other is again
        motion = [np.abs(a.motion - b.motion).max() for a, b in zip(first, other, strict=True)]
        parts = [abs(a.part_m - b.part_m) for a, b in zip(first, other, strict=True)]
        assert max(motion) > 1e-4 or max(parts) > 1e-4
    np.testing.assert_array_equal(hinges(values)[0].motion, first[0].motion)


@pytest.mark.parametrize("bends", [True, False])
def test_hinges_follow_what_is_soft_by_their_slopes(bends):
    """Central differences of 1e-6, motions and parts."""
    superset, step = Superset(load_arm("rv4frl")), 1e-6
    yielding = YieldingLine(line=long_links(superset)[0], bends=bends, word="w")
    told = values_of(yielding, turn_a=0.1, bow_a=0.05, bow_b=-0.08)
    where = ("place", "stretch", "taper", "middle")
    values = told | {"place": 0.3, "stretch": 0.4, "taper": 0.7, "middle": -0.4}
    hinges = hinges_along(superset, yielding, where)
    here = hinges(values)
    for name in where:
        sides = [hinges(values | {name: values[name] + d}) for d in (step, -step)]
        for own, more, less in zip(here, *sides, strict=True):
            moved = dict(own.moved).get(name, np.zeros_like(own.motion))
            np.testing.assert_allclose((more.motion - less.motion) / (2 * step), moved, atol=1e-8)
            part = (more.part_m - less.part_m) / (2 * step)
            assert own.part_slopes.get(name, 0.0) == pytest.approx(part, abs=1e-8)
            assert own.inside.by == ("place", "stretch")


def test_a_soft_stretch_is_a_part_of_the_link_about_its_place():
    np.testing.assert_allclose(soft_places(0.3, 1.0)[0], np.linspace(0.0, 1.0, 6), atol=1e-15)
    np.testing.assert_allclose(soft_places(0.3, 0.0)[0], 0.3)
    for place, stretch in product((0.1, 0.5, 0.9), (0.02, 0.3, 0.8)):
        edges, _ = soft_places(place, stretch)
        assert edges[-1] - edges[0] == pytest.approx(stretch)
        # A whole number of roundings off the ends.
        assert -1e-12 <= edges[0] < edges[-1] <= 1.0 + 1e-12


def test_a_line_turned_as_far_as_it_may_is_still_along_its_link():
    """There an axis is told as a twist; a hundredth further it is an axis."""
    ordinary = Ordinary(superset=Superset(load_arm("rv4frl")), postures=("p",))
    tube = long_links(ordinary.superset)[0]
    twist = Instance(effect=link_torsion.WORDS, place=tube.name)
    turns = [p for p in line_of(False).parameters if " turn " in p.name]
    assert len(turns) == 2
    for parameter, side in zip(turns, across(tube.along).T, strict=True):
        assert parameter.low == -parameter.high
        for angle, along in ((parameter.high, True), (1.01 * parameter.high, False)):
            direction = np.cos(angle) * tube.along + np.sin(angle) * side
            line = link_axis.at_axis(ordinary, tube.link, direction, tube.start_m)
            values = {p.name: p.first for p in line.parameters}
            assert line.is_also(values, twist) is along
