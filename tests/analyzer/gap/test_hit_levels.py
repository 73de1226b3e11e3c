"""Which hits are soft, hard, and clearly between."""

from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.gap.model.hit_levels import has_hits_between, has_levels, middle_level


def session(*peaks_of_points):
    """A session with the peak forces of the hits at each point, N."""
    hits = [
        SimpleNamespace(
            posture="p",
            sensor_point=f"{point}",
            hit_point="0",
            hit_direction=np.array([0.0, 0.0, 1.0]),
            verdict=SimpleNamespace(accepted=True, peak_n=peak),
        )
        for point, peaks in enumerate(peaks_of_points)
        for peak in peaks
    ]
    return SimpleNamespace(hits=hits)


@pytest.mark.parametrize(
    ("peaks", "levels", "between"),
    [
        ((10.0, 30.0, 90.0), True, True),
        ((10.0, 90.0), True, False),  # two levels
        ((10.0, 12.0, 90.0), True, False),  # nearly as soft as the softest
        ((10.0, 80.0, 90.0), True, False),  # nearly as hard as the hardest
        ((10.0, 11.0, 12.0), False, False),  # one level
        ((10.0,), False, False),
    ],
)
def test_a_level_between_is_clearly_between(peaks, levels, between):
    made = session(peaks, peaks)
    assert has_levels(made) is levels
    assert has_hits_between(made) is between


def test_a_point_without_a_hit_between_leaves_two_levels():
    made = session((10.0, 30.0, 90.0), (10.0, 90.0))
    assert has_levels(made)
    assert not has_hits_between(made)


def test_the_middle_is_between_soft_and_hard_hits_in_ratio():
    assert middle_level(session((10.0, 30.0, 90.0))) == pytest.approx(np.log(30.0))
