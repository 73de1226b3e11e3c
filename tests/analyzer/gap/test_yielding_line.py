"""Where a long link gives way, and about which directions, beside closed forms."""

import numpy as np
import pytest

from armodal.analyzer.gap.effects.yielding_line import (
    YieldingLine,
    about_the_line,
    across_the_line,
)
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.long_links import LongLink

LINE = LongLink(
    link=0,
    name="l",
    along=np.array([0.6, 0.0, 0.8]),
    length_m=0.4,
    start_m=np.array([0.1, -0.05, 0.02]),
)


def line_of(ways):
    return YieldingLine(line=LINE, ways=ways(LINE), word="w")


def values_of(yielding, **told):
    """Of its parameters, none where nothing is told."""
    return {p.name: told.get("_".join(p.name.split()[1:3]), 0.0) for p in yielding.parameters}


def yields_of(yielding, **flat):
    """(3, 3) of one place."""
    shares, _ = yielding.shares(values_of(yielding, **flat))
    u = np.stack([way.direction for way in yielding.ways])
    return (u.T * shares) @ u


def test_a_round_casting_yields_alike_about_all_directions_across():
    beside = across(LINE.along)
    np.testing.assert_allclose(yields_of(line_of(across_the_line)), beside @ beside.T, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 6, 1.3, 2.5])
def test_a_flat_casting_is_softer_about_any_direction_by_any_ratio_up_to_three(angle):
    """The mean yield stays; ln of the ratio is |(a, b)| where that is small."""
    bends, beside = line_of(across_the_line), across(LINE.along)
    for much in (0.1, 0.7, 1.5):
        flat = {"flat_a": much * np.cos(2 * angle), "flat_b": much * np.sin(2 * angle)}
        whole = beside.T @ yields_of(bends, **flat) @ beside
        assert np.trace(whole) == pytest.approx(2.0)
        directions, yields = bends.softest(values_of(bends, **flat))
        np.testing.assert_allclose(yields, np.linalg.eigvalsh(whole)[::-1])
        # Of the next order: a third of it, as of a direction between two.
        assert np.log(yields[0] / yields[1]) == pytest.approx(much, rel=0.35 * much)
        soft = beside @ [np.cos(angle), np.sin(angle)]
        assert abs(directions[:, 0] @ soft) > np.cos(0.15 * much)


@pytest.mark.parametrize("ways", [about_the_line, across_the_line])
def test_a_line_that_lies_elsewhere_has_its_hinges_there(ways):
    """To first order in the turn: the second is below half its square."""
    moved = line_of(ways)
    told = {"aside_a": 0.02, "aside_b": -0.03, "turn_a": 0.01, "turn_b": -0.02}
    start, end = moved.ends(values_of(moved, **told))
    along = (end - start) / LINE.length_m
    assert np.linalg.norm(along) == pytest.approx(1.0)
    for way in moved.ways:
        for s in LINE.places_m:
            twist, _ = moved.hinge(values_of(moved, **told), s, way)
            u, place = twist[3:], start + s * along
            if ways is about_the_line:
                np.testing.assert_allclose(u, along, atol=5e-4)
            else:
                assert abs(u @ along) < 5e-4
            np.testing.assert_allclose(twist[:3], np.cross(place, u), atol=5e-4)


@pytest.mark.parametrize("ways", [about_the_line, across_the_line])
def test_hinges_follow_the_line_by_their_slopes(ways):
    """Central differences of 1e-6: products of two parameters leave 1e-12."""
    moved = line_of(ways)
    told = {"aside_a": 0.02, "aside_b": -0.03, "turn_a": 0.1, "turn_b": -0.2}
    values, s, step = values_of(moved, **told), LINE.places_m[1], 1e-6
    for way in moved.ways:
        _, slopes = moved.hinge(values, s, way)
        for name, slope in zip((*moved.aside, *moved.turn), slopes, strict=True):
            more, less = (
                moved.hinge(values | {name: values[name] + d}, s, way)[0] for d in (step, -step)
            )
            np.testing.assert_allclose((more - less) / (2 * step), slope, atol=1e-8)
