"""What stands on a stretch that gives way turns in part."""

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
    back_m = np.array([0.0, 0.07, 0.2])
    for back, own in zip(back_m, STRETCH.turned_about(motion, back_m), strict=True):
        place = hinge - back * ALONG
        np.testing.assert_allclose(own[:3] + np.cross(own[3:], place), 0.0, atol=1e-12)


@pytest.mark.parametrize("place", [0.23, 0.71])
def test_slopes_by_the_place_are_those_of_differences(superset, place):
    line = LongLink(link=1, name="upper_arm", along=ALONG, length_m=0.8)
    shares, h = np.array([0.1, 0.2, 0.2, 0.2, 0.2, 0.1]), 1e-6
    motion = np.random.default_rng(4).standard_normal(6)
    found = line.about(superset, place, "p").moved_slope(motion, shares)
    more, less = (
        line.about(superset, p, "p").moved(motion, shares) for p in (place + h, place - h)
    )
    np.testing.assert_allclose(found, (more - less) / (2.0 * h), atol=1e-6)
    assert np.any(found)
