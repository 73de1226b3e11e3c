"""What stands on a stretch that gives way turns in part."""

import itertools

import numpy as np
import pytest

from armodal.analyzer.gap.model.long_links import LongLink
from armodal.analyzer.gap.model.stretch import Stretch

ALONG = np.array([0.0, 0.6, 0.8])
STRETCH = Stretch(along=ALONG, length_m=0.8, start_m=0.1, end_m=0.5)


def test_before_it_nothing_turns_and_beyond_it_all_turns_about_its_hinge():
    part, back_m, *_ = STRETCH.parts(np.array([0.0, 0.1, 0.5, 0.7]))
    np.testing.assert_array_equal(part, [0.0, 0.0, 1.0, 1.0])
    np.testing.assert_array_equal(back_m[2:], 0.0)


def test_a_beam_under_an_even_moment_leads_there():
    """Curvature 1 / L over the stretch: turned by (t - a) / L, aside by (t - a)^2 / 2 L at t."""
    t = np.array([0.15, 0.3, 0.45])
    part, back_m, *_ = STRETCH.parts(t)
    np.testing.assert_allclose(part, (t - 0.1) / 0.4)
    # Aside by the turn times what is from the place it is about, before the hinge in the middle.
    about = 0.3 - back_m
    np.testing.assert_allclose(part * (t - about), (t - 0.1) ** 2 / 0.8)


def test_a_body_that_turns_about_elsewhere_leaves_that_place_where_it_is():
    rng = np.random.default_rng(3)
    turn, hinge = rng.standard_normal(3), rng.standard_normal(3)
    motion = np.concatenate([np.cross(hinge, turn), turn])  # of the origin, by a turn about it
    back_m, part = np.array([0.0, 0.07, 0.2]), np.array([1.0, 0.8, 0.3])
    moved = STRETCH.turned_about(motion, part, part * back_m)
    for back, own in zip(back_m, moved, strict=True):
        place = hinge - back * ALONG
        np.testing.assert_allclose(own[:3] + np.cross(own[3:], place), 0.0, atol=1e-12)


def test_pieces_move_as_all_that_is_of_them_does():
    """Against sums over a thousand places of each: the error is that of the rule of midpoints."""
    shares = np.array([0.1, 0.2, 0.4, 0.3])
    part, lever, *_ = STRETCH.of_pieces(shares)
    edges = np.concatenate([[0.0], np.cumsum(shares)]) * STRETCH.length_m
    for i, (start, end) in enumerate(itertools.pairwise(edges)):
        t = start + (np.arange(1000) + 0.5) / 1000 * (end - start)
        parts, back_m, *_ = STRETCH.parts(t)
        assert part[i] == pytest.approx(parts.mean(), abs=1e-5)
        assert lever[i] == pytest.approx((parts * back_m).mean(), abs=1e-6)


def test_a_piece_without_mass_moves_as_what_stands_there():
    part, lever, *_ = STRETCH.of_pieces(np.array([0.3, 0.0, 0.7]))
    here, back_m, *_ = STRETCH.parts(np.array([0.3 * STRETCH.length_m]))
    # Differences over a millionth of a length: rounding leaves 1e-10.
    assert part[1] == pytest.approx(here[0], abs=1e-8)
    assert lever[1] == pytest.approx((here * back_m)[0], abs=1e-8)


def test_slopes_by_both_ends_are_those_of_differences(superset):
    """One slice of a short stretch, for points and for pieces; second differences leave 1e-7."""
    line = LongLink(link=1, name="upper_arm", along=ALONG, length_m=0.8)
    shares, h = np.array([0.1, 0.2, 0.2, 0.2, 0.2, 0.1]), 1e-6
    motion = np.random.default_rng(4).standard_normal(6)
    slopes = {"p": (0.4, 0.7), "w": (-0.3, 0.5)}
    first = next(p for p in superset.arm.points if p.link == superset.arm.joints[1].link.name)
    at = float(first.position_m @ ALONG) / line.length_m
    begins, ends = at - 0.1, at + 0.15  # a point stands in it
    here = line.inside(superset, (begins, ends), slopes)
    for name, (start, end) in slopes.items():
        more, less = (line.inside(superset, (begins + d * start, ends + d * end)) for d in (h, -h))
        found = here.moved_slope(motion, shares, name)
        want = (more.moved(motion, shares) - less.moved(motion, shares)) / (2.0 * h)
        np.testing.assert_allclose(found, want, atol=1e-6)
        q = here.by.index(name)
        parts = (more.part - less.part) / (2.0 * h)
        np.testing.assert_allclose(here.part_slopes[q], parts, atol=1e-6)
        # What does not turn turns about anything.
        lever_m = [own.part[:, None] * own.shift_m for own in (more, less)]
        by = here.part_slopes[q][:, None] * here.shift_m
        by += here.part[:, None] * here.shift_slopes_m[q]
        np.testing.assert_allclose(by, (lever_m[0] - lever_m[1]) / (2.0 * h), atol=1e-6)
        assert np.any(here.part_slopes[q])


@pytest.mark.parametrize("place", [0.23, 0.71])
def test_slopes_by_the_place_are_those_of_differences(superset, place):
    line = LongLink(link=1, name="upper_arm", along=ALONG, length_m=0.8)
    shares, h = np.array([0.1, 0.2, 0.2, 0.2, 0.2, 0.1]), 1e-6
    motion = np.random.default_rng(4).standard_normal(6)
    found = line.about(superset, place, "p").moved_slope(motion, shares, "p")
    more, less = (
        line.about(superset, p, "p").moved(motion, shares) for p in (place + h, place - h)
    )
    np.testing.assert_allclose(found, (more - less) / (2.0 * h), atol=1e-6)
    assert np.any(found)
